#pragma once

#include <array>
#include <cstdint>

namespace shadowcache {

/// Sides of a surface: side 2k (2k + 1) holds the normals whose largest component is +k (-k).
inline constexpr int kSides = 6;

/// Most layers of one side in a voxel.
inline constexpr int kMaxLayers = 4;

/// How often a patch may be cut into quarters.
inline constexpr int kMaxCuts = 3;

/// Which part of a patch: one digit, 1 to 4 in base 5, for each time it was cut into quarters, the
/// first cut's in front; 0 where it was not cut further. Quarter 1 + a + 2 b is the upper (1) or
/// lower (0) half along the axes that follow the side's own one: a along the next, b along the one
/// after it.
using PartCode = int;
inline constexpr PartCode kParts = 125;

/// Times that the patch was cut to this part.
constexpr int cutsOf(PartCode part) {
    return part == 0 ? 0 : part % 25 == 0 ? 1 : part % 5 == 0 ? 2 : 3;
}

/// Share of the whole layer that the part is.
constexpr float shareOf(PartCode part) {
    return 1.0f / static_cast<float>(1 << 2 * cutsOf(part));
}

/// Quarter `quarter` (0 .. 3) of a part that was cut less than kMaxCuts times.
constexpr PartCode quarterOf(PartCode part, int quarter) {
    constexpr std::array<int, kMaxCuts> kPlace{25, 5, 1};
    return part + (quarter + 1) * kPlace[static_cast<std::size_t>(cutsOf(part))];
}

/// The box of a part along the two axes that follow the side's own: its middle, from the voxel's
/// middle, in spacings. It is 2^-cuts spacings wide.
constexpr std::array<float, 2> middleOf(PartCode part) {
    std::array<float, 2> middle{0, 0};
    float step = 0.25f;
    for (int place = 25; place > 0 && part / place % 5 > 0; place /= 5, step /= 2) {
        const int quarter = part / place % 5 - 1;
        middle[0] += quarter & 1 ? step : -step;
        middle[1] += quarter & 2 ? step : -step;
    }
    return middle;
}

/// Which patch of a voxel's surface an item is, in one number.
struct PatchCode {
    int side = 0;       ///< 0 .. kSides - 1
    int layer = 0;      ///< 0 .. kMaxLayers - 1, along the side's normal
    PartCode part = 0;  ///< 0: the whole layer

    constexpr std::int16_t packed() const {
        return static_cast<std::int16_t>(part + kParts * (layer + kMaxLayers * side));
    }
    static constexpr bool isValid(std::int16_t packed) {
        const int part = packed % kParts;
        // No cut comes after none.
        return packed >= 0 && packed < kParts * kMaxLayers * kSides &&
               (part / 25 > 0 || part == 0) && (part / 5 % 5 > 0 || part % 5 == 0);
    }
    static constexpr PatchCode of(std::int16_t packed) {
        return {packed / (kParts * kMaxLayers), packed / kParts % kMaxLayers, packed % kParts};
    }
};

}  // namespace shadowcache
