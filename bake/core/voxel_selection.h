#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "bake/core/placement.h"
#include "common/cache/cache_items.h"

namespace shadowcache {

/// Places at which a cache is looked up, rounded: to an eighth of a voxel, and the normals to cells
/// of the direction mesh.
class LookupPlaces {
public:
    struct Place {
        std::uint64_t voxelKey;  ///< the first, along each axis, of the eight voxels around it
        std::uint32_t code;      ///< of its position between them, and of its normal

        /// Its position from the middle of that voxel, in spacings, in [0, 1).
        Vec3f position() const;
        Vec3f normal() const;
        /// Cell of the direction mesh that the normal is in, at a level <= 4.
        std::uint32_t normalCell(int level) const;
        /// Whether its numbers are in their ranges, as those of makePlace() are.
        bool isValid() const;

        auto operator<=>(const Place&) const = default;
    };

    /// @param position  from the middle of the voxel, in spacings, in [0, 1)
    /// @param normal    unit
    static Place makePlace(std::uint64_t voxelKey, const Vec3f& position, const Vec3f& normal);

    void add(std::vector<Place> places);

    /// In order, each once.
    const std::vector<Place>& places() const { return places_; }

private:
    std::vector<Place> places_;
};

/// Sides of voxels: bit s stands for side s of PatchCode.
class VoxelSides {
public:
    VoxelSides() = default;
    /// The sides that have items. A bake makes all items of a side or none.
    VoxelSides(const VoxelFrame& frame, const CacheItems& items);

    void add(std::uint64_t voxelKey, int side) {
        voxels_[voxelKey] |= static_cast<std::uint8_t>(1u << side);
    }
    bool contains(std::uint64_t voxelKey, int side) const;
    bool empty() const { return voxels_.empty(); }

private:
    std::unordered_map<std::uint64_t, std::uint8_t> voxels_;  ///< by key
};

/// Which items of a set a bake makes, as sides of voxels. Items are pure functions of the set, the
/// options and their voxel, so those of any selection are those of the whole bake.
struct VoxelSelection {
    std::optional<LookupPlaces>
        lookups;         ///< only the items that these lookups find; none: all items
    int margin = 0;      ///< and the items at most so many voxels around these
    VoxelSides present;  ///< left out: another cache holds them

    bool everything() const { return !lookups && present.empty(); }
};

}  // namespace shadowcache
