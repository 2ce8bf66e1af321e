#pragma once

#include <bitset>
#include <cstdint>
#include <unordered_map>

#include "common/math/vec.h"

namespace shadowcache {

class VoxelFrame;

/// Some voxels of a frame, by their keys (VoxelFrame::key).
class VoxelKeys {
public:
    void add(std::uint64_t key) { leaves_[key >> 9].set(key & 511); }

    bool contains(std::uint64_t key) const {
        const auto leaf = leaves_.find(key >> 9);
        return leaf != leaves_.end() && leaf->second.test(key & 511);
    }

    /// Calls `visit` with the key of each, in no order.
    template <class Visit>
    void forEach(const Visit& visit) const {
        for (const auto& [leaf, bits] : leaves_)
            for (std::uint64_t i = 0; i < bits.size(); ++i)
                if (bits.test(i)) visit(leaf << 9 | i);
    }

    /// False if none of the voxels `first` to `last` along each axis is one of these. True does not
    /// say that one is: large boxes are not searched voxel by voxel.
    bool mayTouch(const VoxelFrame& frame, const Vec3i& first, const Vec3i& last) const;

private:
    std::unordered_map<std::uint64_t, std::bitset<512>> leaves_;  ///< by key >> 9
};

}  // namespace shadowcache
