#pragma once

#include <bitset>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>

#include "bake/core/patch.h"
#include "bake/core/placement.h"
#include "bake/core/voxel_keys.h"
#include "common/cache/cache_items.h"

namespace shadowcache {

/// Level of the cells of the direction mesh by which normals are told apart.
inline constexpr int kNormalLevel = 2;

/// Normals by their cells; bit c stands for cell c of kNormalLevel.
using NormalSet = std::bitset<cellCount(kNormalLevel)>;

/// Lookups in a cache: the voxels they go to, and with which normals.
class VoxelLookups {
public:
    /// @param normal  cell of kNormalLevel
    void add(std::uint64_t voxelKey, std::uint32_t normal) { voxels_[voxelKey].set(normal); }
    void add(const VoxelLookups& more);

    /// The same, each made `margin` voxels farther in every direction as well.
    VoxelLookups dilated(const VoxelFrame& frame, int margin) const;

    /// Normals of the lookups that go to a voxel; null if there are none.
    const NormalSet* find(std::uint64_t voxelKey) const;
    const std::unordered_map<std::uint64_t, NormalSet>& voxels() const { return voxels_; }

private:
    std::unordered_map<std::uint64_t, NormalSet> voxels_;  ///< by key
};

/// Sides of voxels: bit s stands for side s of PatchCode.
class VoxelSides {
public:
    VoxelSides() = default;
    /// Those that items are of. A bake makes all items of a side or none.
    VoxelSides(const VoxelFrame& frame, const CacheItems& items);

    void add(std::uint64_t voxelKey, int side) {
        voxels_[voxelKey] |= static_cast<std::uint8_t>(1u << side);
    }
    bool contains(std::uint64_t voxelKey, int side) const;
    /// Number of voxels, and of sides of all of them.
    std::size_t voxels() const { return voxels_.size(); }
    std::size_t sides() const;

private:
    std::unordered_map<std::uint64_t, std::uint8_t> voxels_;  ///< by key
};

/// Which items of a set a bake makes. Items are pure functions of the set, the options and their
/// voxel, so those of any selection are those of the whole bake.
struct VoxelSelection {
    std::optional<VoxelLookups> lookups;  ///< only what these find; none: everything
    VoxelSides present;                   ///< and not these, which another cache holds

    /// False if no item of the voxel is wanted.
    bool mayWant(std::uint64_t voxelKey) const { return !lookups || lookups->find(voxelKey); }

    /// Whether the items of the side that `patches`, its depth layers, are of are wanted.
    bool wants(std::uint64_t voxelKey, std::span<const Patch> patches, double spacing) const;
};

}  // namespace shadowcache
