#pragma once

#include <string>
#include <vector>

#include "common/cache/cache_items.h"

namespace shadowcache {

/// What a grid's numbers are, so that a volume tool treats them right.
enum class VolumeKind {
    fog,        ///< a share, 0 to 1: a fog volume
    direction,  ///< turns with the set
    color       ///< does not turn
};

/// A grid as volume tools show it: one value a voxel.
struct VolumeGrid {
    std::string name;
    VolumeKind kind;
    std::vector<Vec3f> values;  ///< a fog volume's in x
};

/// The voxels of a cache, each with its run of items.
struct VoxelRuns {
    std::vector<Vec3i> voxels;
    std::vector<std::size_t> firstItem;  ///< voxels + 1
};
VoxelRuns findVoxels(const CacheItems& items);

/// Sky visibility: mean of n/d over the counted base regions of all items of each voxel (grid
/// `openness`).
VolumeGrid skyVisibilityGrid(const CacheHeader& header, const CacheItems& items,
                             const VoxelRuns& runs);

/// Bent normal, not normalised: mean over the same regions of n/d times the region's centre (grid
/// `open_direction`).
VolumeGrid bentNormalGrid(const CacheHeader& header, const CacheItems& items,
                          const VoxelRuns& runs);

/// Writes grids over the voxels to an OpenVDB file of their own; beside it first, then renamed.
///
/// @throws Error when it cannot be written
void writeVolumes(const std::filesystem::path& path, const CacheHeader& header,
                  const std::vector<Vec3i>& voxels, const std::vector<VolumeGrid>& grids);

}  // namespace shadowcache
