#pragma once

#include <array>
#include <cstdint>

namespace shadowcache {

/// Sides of a surface: side 2k (2k + 1) holds the normals whose largest component is +k (-k).
inline constexpr int kSides = 6;

/// Most depth layers of one side in a voxel.
inline constexpr int kMaxDepthLayers = 4;

/// Levels of a patch's quadtree below the whole patch.
inline constexpr int kMaxSubdivisions = 3;

/// Node of a patch's quadtree: one digit, 1 to 4 in base 5, for each level, the first subdivision's
/// in front; 0 where the node is not subdivided further. Digit 1 + a + 2 b is the upper (1) or
/// lower (0) half along the axes that follow the side's own one: a along the next, b along the one
/// after it.
using SubpatchCode = int;
inline constexpr SubpatchCode kSubpatchCodes = 125;

/// Level of a subpatch in the quadtree; 0 is the whole patch.
constexpr int subdivisionsOf(SubpatchCode subpatch) {
    return subpatch == 0 ? 0 : subpatch % 25 == 0 ? 1 : subpatch % 5 == 0 ? 2 : 3;
}

/// Share of the whole patch that the subpatch covers.
constexpr float shareOf(SubpatchCode subpatch) {
    return 1.0f / static_cast<float>(1 << 2 * subdivisionsOf(subpatch));
}

/// Child `child` (0 .. 3) of a subpatch above the last level.
constexpr SubpatchCode subpatchOf(SubpatchCode parent, int child) {
    constexpr std::array<int, kMaxSubdivisions> kPlace{25, 5, 1};
    return parent + (child + 1) * kPlace[static_cast<std::size_t>(subdivisionsOf(parent))];
}

/// Centre of a subpatch's box along the two axes that follow the side's own, from the voxel's
/// centre, in spacings. The box is 2^-subdivisions spacings wide.
constexpr std::array<float, 2> middleOf(SubpatchCode subpatch) {
    std::array<float, 2> middle{0, 0};
    float step = 0.25f;
    for (int place = 25; place > 0 && subpatch / place % 5 > 0; place /= 5, step /= 2) {
        const int child = subpatch / place % 5 - 1;
        middle[0] += child & 1 ? step : -step;
        middle[1] += child & 2 ? step : -step;
    }
    return middle;
}

/// Which patch of a voxel's surface an item is, in one number.
struct PatchCode {
    int side = 0;               ///< 0 .. kSides - 1
    int layer = 0;              ///< depth layer, 0 .. kMaxDepthLayers - 1, along the side's normal
    SubpatchCode subpatch = 0;  ///< 0: the whole layer

    constexpr std::int16_t packed() const {
        return static_cast<std::int16_t>(subpatch +
                                         kSubpatchCodes * (layer + kMaxDepthLayers * side));
    }
    static constexpr bool isValid(std::int16_t packed) {
        const int subpatch = packed % kSubpatchCodes;
        // No subdivision follows none.
        return packed >= 0 && packed < kSubpatchCodes * kMaxDepthLayers * kSides &&
               (subpatch / 25 > 0 || subpatch == 0) && (subpatch / 5 % 5 > 0 || subpatch % 5 == 0);
    }
    static constexpr PatchCode of(std::int16_t packed) {
        return {packed / (kSubpatchCodes * kMaxDepthLayers),
                packed / kSubpatchCodes % kMaxDepthLayers, packed % kSubpatchCodes};
    }
};

}  // namespace shadowcache
