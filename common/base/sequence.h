#pragma once

#include <cstdint>
#include <span>

namespace shadowcache {

/// Well-mixed 64-bit hash of up to three words; the source of all randomness.
/// [Steele et al. 2014, SplitMix64's finaliser]
constexpr std::uint64_t mixBits(std::uint64_t v) {
    v ^= v >> 30;
    v *= 0xbf58476d1ce4e5b9ull;
    v ^= v >> 27;
    v *= 0x94d049bb133111ebull;
    v ^= v >> 31;
    return v;
}
constexpr std::uint64_t hashWords(std::uint64_t a, std::uint64_t b = 0, std::uint64_t c = 0) {
    return mixBits(mixBits(mixBits(a + 0x9e3779b97f4a7c15ull) + b * 0xd1342543de82ef95ull) +
                   c * 0xaf251af3b0f025b5ull);
}

/// Number in [0, 1) from the upper 53 bits of a hash.
constexpr double toUnit(std::uint64_t hash) {
    return static_cast<double>(hash >> 11) * 0x1p-53;
}

/// Number in [0, 1) from the upper 24 bits of a 32-bit word.
constexpr float toUnitFloat(std::uint32_t word) {
    return static_cast<float>(word >> 8) * 0x1p-24f;
}

/// Where numbers in [0, 1) come from: Owen-scrambled Sobol' points; hashes; or Hammersley points
/// with the radical inverse of Larcher and Pillichshammer, randomised by XOR or by a shift.
enum class Sequence { sobol, random, larcherXor, larcherShift };

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
