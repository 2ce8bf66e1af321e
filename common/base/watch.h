#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "common/base/error.h"

namespace shadowcache {

/// A signal, or who watches the call, has asked for the end.
class Interrupted : public Error {
public:
    /// The end that was asked for.
    Interrupted() : Error("interrupted") {}
};

/// Watches calls of the library from outside: may end them, and is told how far they are.
struct Watch {
    /// Set by any thread: what is watched ends soon with Interrupted.
    std::atomic<bool> stop{false};
    /// Called by the working threads in place of printing, ten times a second at most.
    std::function<void(const std::string& task, std::uint64_t done, std::uint64_t total)>
        onProgress = [](const std::string&, std::uint64_t, std::uint64_t) {};
};

/// Until its end, all that its thread does is watched, with the parallel loops that it starts. Any
/// number of threads may have one each at once.
class WatchScope {
public:
    /// @param watch  outlives the scope; null: nobody watches
    explicit WatchScope(Watch* watch) noexcept;
    ~WatchScope();
    WatchScope(const WatchScope&) = delete;
    WatchScope& operator=(const WatchScope&) = delete;

private:
    Watch* before_;
};

/// Who watches this thread, or null.
Watch* currentWatch() noexcept;

/// @throws Interrupted if the caller of this thread has asked to stop
void throwIfStopped();

}  // namespace shadowcache
