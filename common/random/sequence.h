#pragma once

#include <cstdint>
#include <span>

#include "common/base/hash.h"
#include "common/base/named.h"

namespace shadowcache {

/// Where numbers in [0, 1) come from: Owen-scrambled Sobol' points; hashes; or Hammersley points
/// with the radical inverse of Larcher and Pillichshammer, randomised by XOR or by a shift.
enum class Sequence { sobol, random, larcherXor, larcherShift };

/// Names accepted by --sequence.
inline constexpr Named<Sequence> kSequences[] = {{"sobol", Sequence::sobol},
                                                 {"random", Sequence::random},
                                                 {"larcher-xor", Sequence::larcherXor},
                                                 {"larcher-shift", Sequence::larcherShift}};

/// Dimensions that owenSobol offers.
inline constexpr int kSobolDimensions = 4;

/// `out[i]` = 32-bit word of point `first + i` of the Sobol' sequence in `dimension`
/// (< kSobolDimensions), Owen-scrambled by `seed`. A pure function of its arguments; any two
/// dimensions with one seed form a (0, 2)-sequence where Sobol' does. Vectorised over i.
///
/// Source: Joe & Kuo 2008 (direction numbers); Burley 2020, "Practical Hash-based Owen Scrambling"
/// (seeds per dimension must differ; the shuffle of the index, too, comes from `seed`).
void owenSobol(std::uint32_t first, int dimension, std::uint64_t seed,
               std::span<std::uint32_t> out) noexcept;

/// Radical inverse of Larcher and Pillichshammer in base 2, as a 32-bit fraction: with i / 2^m it
/// makes (0, m, 2)-nets of less discrepancy than van der Corput's. [Kollig & Keller 2002]
constexpr std::uint32_t larcherPillichshammer(std::uint32_t i) {
    std::uint32_t inverse = 0;
    for (std::uint32_t v = 0x80000000u; i != 0; i >>= 1, v |= v >> 1)
        if (i & 1) inverse ^= v;
    return inverse;
}

/// `out[i]` = word of point `first + i` in `dimension` (< kSobolDimensions) of a randomised set of
/// `total` points (>= first + out.size()). Each word alone is uniform over 32 bits, over the seeds.
void fillSequence(Sequence sequence, int dimension, std::uint64_t seed, std::uint32_t first,
                  std::uint32_t total, std::span<std::uint32_t> out) noexcept;

}  // namespace shadowcache
