#pragma once

#include <cstdint>

#include "common/random/salts.h"

namespace shadowcache {

/// Number in [0, 1) of 53 bits from sample word `i` of a pixel: the bits below the word's come from
/// a hash. 32 bits are few to choose one of many texels or triangles.
inline double fullPrecision(std::uint32_t word, std::uint64_t seed, std::uint64_t i) {
    const std::uint64_t low = hashWords(seed, RenderSalt::lowBits, i) >> 43;
    return (static_cast<double>(word) + static_cast<double>(low) * 0x1p-21) * 0x1p-32;
}

}  // namespace shadowcache
