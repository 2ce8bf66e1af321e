#include "tests/study/estimators/larcher_sequence.h"

#include "common/random/salts.h"

namespace shadowcache::study {

namespace {

/// Randomises a dimension; family of 4 that RenderSalt leaves free.
constexpr auto kRandomise = static_cast<RenderSalt>(32);

template <class Combine>
void fillLarcher(const Sequence& sequence, std::uint32_t first, int dimension, std::uint64_t seed,
                 std::span<std::uint32_t> out, const Combine& combine) noexcept {
    const auto random = static_cast<std::uint32_t>(hashWords(seed, kRandomise + dimension) >> 32);
    for (std::size_t i = 0; i < out.size(); ++i) {
        const std::uint32_t point = first + static_cast<std::uint32_t>(i);
        const std::uint32_t word =
            dimension % 2 == 0
                ? static_cast<std::uint32_t>((std::uint64_t{point} << 32) / sequence.points)
                : larcherPillichshammer(point);
        out[i] = combine(word, random);
    }
}

void fillXor(const Sequence& sequence, std::uint32_t first, int dimension, std::uint64_t seed,
             std::span<std::uint32_t> out) noexcept {
    fillLarcher(sequence, first, dimension, seed, out,
                [](std::uint32_t word, std::uint32_t random) { return word ^ random; });
}

void fillShift(const Sequence& sequence, std::uint32_t first, int dimension, std::uint64_t seed,
               std::span<std::uint32_t> out) noexcept {
    fillLarcher(sequence, first, dimension, seed, out,
                [](std::uint32_t word, std::uint32_t random) { return word + random; });
}

}  // namespace

Sequence larcherXor(std::uint32_t points) {
    return {fillXor, points};
}

Sequence larcherShift(std::uint32_t points) {
    return {fillShift, points};
}

}  // namespace shadowcache::study
