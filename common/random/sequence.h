#pragma once

#include <cstdint>
#include <span>

#include "common/base/hash.h"
#include "common/base/named.h"

namespace shadowcache {

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

/// Where the numbers of samples come from: Owen-scrambled Sobol' points unless it says otherwise.
struct Sequence {
    using Words = void(const Sequence& sequence, std::uint32_t first, int dimension,
                       std::uint64_t seed, std::span<std::uint32_t> out) noexcept;
    Words* words = nullptr;    ///< makes them; null: owenSobol()
    std::uint32_t points = 0;  ///< of a finite set; 0: endless

    /// `out[i]` = word of point `first + i` in `dimension` (< kSobolDimensions). Each word alone is
    /// uniform over 32 bits, over the seeds.
    void fill(std::uint32_t first, int dimension, std::uint64_t seed,
              std::span<std::uint32_t> out) const noexcept;
    bool operator==(const Sequence&) const = default;

    static const Sequence kSobol, kRandom;
};

/// Words that are hashes: independent of each other.
void randomWords(const Sequence& sequence, std::uint32_t first, int dimension, std::uint64_t seed,
                 std::span<std::uint32_t> out) noexcept;

inline constexpr Sequence Sequence::kSobol{};
inline constexpr Sequence Sequence::kRandom{randomWords};

/// Names accepted by --sequence.
inline constexpr Named<Sequence> kSequences[] = {{"sobol", Sequence::kSobol},
                                                 {"random", Sequence::kRandom}};

}  // namespace shadowcache
