#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "common/base/interrupt.h"
#include "common/base/named.h"

namespace shadowcache {

/// How progress is shown on standard error.
enum class ProgressStyle {
    none,
    bar,    ///< one line that is rewritten, for a terminal
    lines,  ///< "bake: 40 %, 12 s left", for logs
    json    ///< {"task":"bake","done":4,"total":10,"seconds":8.0,"left":12.0} a line, for programs
};

/// Names accepted by --progress.
inline constexpr Named<ProgressStyle> kProgressStyles[] = {{"none", ProgressStyle::none},
                                                           {"bar", ProgressStyle::bar},
                                                           {"lines", ProgressStyle::lines},
                                                           {"json", ProgressStyle::json}};

/// A bar on a terminal, lines elsewhere.
ProgressStyle standardProgressStyle();

/// Chooses the style of all progress from here on; without a call, as in the library, none is
/// shown.
///
/// @param milliseconds  between two prints; none: as Progress has them
void setProgressStyle(ProgressStyle style, std::optional<std::int64_t> milliseconds = {});

/// Counts finished work and shows it with the time left: a bar ten times a second, lines every ten
/// seconds (work that is shorter shows none), JSON every second and when all is done. Where
/// somebody watches (watch.h), that one is told instead. Thread-safe.
class Progress {
public:
    /// @param label what is being done ("bake"); without characters that JSON escapes
    /// @param total units of work, > 0
    Progress(std::string label, std::uint64_t total);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Adds finished units; prints when it is time to.
    void add(std::uint64_t units);

private:
    void show(std::uint64_t done, double seconds) const;

    std::string label_;
    std::uint64_t total_;
    Watch* watch_;
    ProgressStyle style_;
    std::int64_t intervalMilliseconds_;
    std::chrono::steady_clock::time_point start_;
    std::atomic<std::uint64_t> done_{0};
    std::atomic<std::int64_t> nextPrintMilliseconds_;
    std::atomic<bool> printed_{false};
};

}  // namespace shadowcache
