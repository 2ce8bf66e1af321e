#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace shadowcache {

/// "12 %": 100 times a share with that many significant digits, without a power of ten and without
/// zeros behind the decimal point that say nothing.
///
/// @param digits  1 to 9
inline std::string percentText(double share, int digits) {
    constexpr int kMostDecimals = 12;
    const double percent = 100 * share;
    const double place =
        percent != 0 && std::isfinite(percent) ? std::floor(std::log10(std::abs(percent))) : 0;
    const int decimals = std::clamp(digits - 1 - static_cast<int>(place), 0, kMostDecimals);
    std::string result = fmt::format("{:.{}f}", percent, decimals);
    if (result.find('.') != std::string::npos) {
        result.erase(result.find_last_not_of('0') + 1);
        if (result.ends_with('.')) result.pop_back();
    }
    return result + " %";
}

}  // namespace shadowcache
