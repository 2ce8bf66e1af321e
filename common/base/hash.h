#pragma once

#include <cstdint>

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

}  // namespace shadowcache
