#pragma once

#include "common/base/hash.h"

namespace shadowcache {

// Second words of hashWords: what the numbers drawn from a seed are for. Two uses of one seed with
// one salt would draw the same numbers, so every salt has a value and a use of its own, which
// tests/source_check verifies. The bake's seeds never meet the renderer's.

enum class BakeSalt : std::uint64_t {
    originU = 1,  ///< place of an origin in its triangle
    originV = 2,
    rays = 0x72617973,     ///< directions and origins of an item's rays; third word: which step's
    patch = 0x7061746368,  ///< a patch's own seed; third word: its code
};

/// With a family's name stands the number of values that follow it.
enum class RenderSalt : std::uint64_t {
    owenScramble = 1,  ///< a dimension of Sobol' points; family of 4
    randomWord = 16,   ///< a word of a random sequence, by dimension; family of 4
    larcherWord = 32,  ///< randomises a dimension of Larcher-Pillichshammer points; family of 4
};

/// Member `i` of a salt's family.
constexpr RenderSalt operator+(RenderSalt family, int i) {
    return static_cast<RenderSalt>(static_cast<std::uint64_t>(family) +
                                   static_cast<std::uint64_t>(i));
}

constexpr std::uint64_t hashWords(std::uint64_t seed, BakeSalt salt, std::uint64_t c = 0) {
    return hashWords(seed, static_cast<std::uint64_t>(salt), c);
}
constexpr std::uint64_t hashWords(std::uint64_t seed, RenderSalt salt, std::uint64_t c = 0) {
    return hashWords(seed, static_cast<std::uint64_t>(salt), c);
}

}  // namespace shadowcache
