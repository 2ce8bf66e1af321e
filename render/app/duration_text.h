#pragma once

#include <fmt/core.h>

#include <string>

namespace shadowcache {

/// A rough time for people: "2.5 s", "4 min", "1.5 h".
inline std::string durationText(double seconds) {
    if (seconds < 100) return fmt::format("{:.2g} s", seconds);
    return seconds < 5400 ? fmt::format("{:.0f} min", seconds / 60)
                          : fmt::format("{:.1f} h", seconds / 3600);
}

}  // namespace shadowcache
