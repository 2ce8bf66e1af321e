#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>

#include "common/base/error.h"

namespace shadowcache {

/// Counts finished work and shows it, with the time left, on standard error when that is a
/// terminal; silent in a pipe. Thread-safe.
class Progress {
public:
    /// @param label what is being done ("bake")
    /// @param total units of work, > 0
    Progress(std::string label, std::uint64_t total);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Adds finished units; prints at most ten times a second.
    void add(std::uint64_t units);

private:
    void print(std::uint64_t done, double seconds);

    std::string label_;
    std::uint64_t total_;
    bool terminal_;
    std::chrono::steady_clock::time_point start_;
    std::atomic<std::uint64_t> done_{0};
    std::atomic<std::int64_t> nextPrintMilliseconds_{0};
};

/// Makes Ctrl-C and SIGTERM ask for a clean end instead of killing the process at once (a second
/// signal does kill it).
void installInterruptHandler();

/// A signal has asked for the end.
class Interrupted : public Error {
public:
    Interrupted() : Error("interrupted") {}
};

/// @throws Interrupted once a signal has asked for the end. Cheap; long loops call it often.
void throwIfInterrupted();

}  // namespace shadowcache
