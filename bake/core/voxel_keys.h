#pragma once

#include <bitset>
#include <cstdint>
#include <unordered_map>

#include "common/math/vec.h"

namespace shadowcache {

/// Some voxels of a frame, by their keys (VoxelFrame::key).
class VoxelKeys {
public:
    void add(std::uint64_t key) { leaves_[key >> 9].set(key & 511); }

    bool contains(std::uint64_t key) const {
        const auto leaf = leaves_.find(key >> 9);
        return leaf != leaves_.end() && leaf->second.test(key & 511);
    }

    /// False if none of the voxels `first` to `last` along each axis is one of these. True does not
    /// say that one is: large boxes are not searched voxel by voxel.
    ///
    /// @param keyOf  VoxelFrame::key of the frame
    template <class KeyOf>
    bool mayTouch(const Vec3i& first, const Vec3i& last, const KeyOf& keyOf) const {
        if (count(first, last, 1) <= kMostSteps)
            return anyOf(first, last, 1, [&](const Vec3i& v) { return contains(keyOf(v)); });
        const Vec3i leaf(first.x & ~7, first.y & ~7, first.z & ~7);
        return count(leaf, last, 8) > kMostSteps || anyOf(leaf, last, 8, [&](const Vec3i& v) {
                   return leaves_.contains(keyOf(v) >> 9);
               });
    }

private:
    /// Voxels, or else leaves, of a box that are looked at one by one.
    static constexpr double kMostSteps = 64;

    static double count(const Vec3i& first, const Vec3i& last, int step) {
        const Vec3d size = Vec3d(last - first) / step + Vec3d(1);
        return size.x * size.y * size.z;
    }

    /// Whether `isThere` for one of the voxels of a box, `step` apart.
    template <class IsThere>
    static bool anyOf(const Vec3i& first, const Vec3i& last, int step, const IsThere& isThere) {
        for (int x = first.x; x <= last.x; x += step)
            for (int y = first.y; y <= last.y; y += step)
                for (int z = first.z; z <= last.z; z += step)
                    if (isThere(Vec3i(x, y, z))) return true;
        return false;
    }

    std::unordered_map<std::uint64_t, std::bitset<512>> leaves_;  ///< by key >> 9
};

}  // namespace shadowcache
