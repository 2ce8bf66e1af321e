#pragma once

#include "common/random/sequence.h"

namespace shadowcache::study {

/// Radical inverse of Larcher and Pillichshammer in base 2, as a 32-bit fraction: with i / 2^m it
/// makes (0, m, 2)-nets of less discrepancy than van der Corput's. [Kollig & Keller 2002]
constexpr std::uint32_t larcherPillichshammer(std::uint32_t i) {
    std::uint32_t inverse = 0;
    for (std::uint32_t v = 0x80000000u; i != 0; i >>= 1, v |= v >> 1)
        if (i & 1) inverse ^= v;
    return inverse;
}

/// Hammersley sets of `points` (> 0) points with that inverse, randomised by XOR or by a shift:
/// i / points in even dimensions, the inverse in odd ones. For estimators that draw all samples of
/// a pixel from one such set. [paper 3.2]
Sequence larcherXor(std::uint32_t points);
Sequence larcherShift(std::uint32_t points);

}  // namespace shadowcache::study
