#pragma once

#include <algorithm>
#include <cstdint>

namespace shadowcache {

/// Values of texels that a byte of a picture's file stands for, at most: a constant map of 16k has
/// 14,000 with DWAB, the densest compression.
inline constexpr std::uint64_t kMostValuesPerByte = 16384;
/// Small pictures may be as empty as they like: 64 MB.
inline constexpr std::uint64_t kValuesAlwaysAllowed = std::uint64_t{1} << 24;

/// Whether a file of `bytes` may stand for so many values. In double, which cannot overflow.
inline bool mayHoldValues(std::uint64_t bytes, double values) {
    return values <=
           static_cast<double>(std::max(kValuesAlwaysAllowed, kMostValuesPerByte * bytes));
}

}  // namespace shadowcache
