#pragma once

#include <string>
#include <vector>

#include "common/cache/cache_items.h"

namespace shadowcache {

/// Names of the volume grids in a cache file (docs/format.md).
inline constexpr const char* kSkyVisibilityGrid = "openness";
inline constexpr const char* kBentNormalGrid = "open_direction";

/// What a grid's numbers are, so that a volume tool treats them right.
enum class VolumeKind {
    fog,        ///< a share, 0 to 1: a fog volume
    direction,  ///< turns with the set
    color       ///< does not turn
};

/// A grid as volume tools show it: one value a voxel of the cache, in the order of
/// VoxelRuns::voxels.
struct VolumeGrid {
    std::string name;
    VolumeKind kind;
    std::vector<Vec3f> values;  ///< of a fog volume only x counts
};

/// The voxels of a cache, each with its run of items: voxel v has those from firstItem[v] up to,
/// but without, firstItem[v + 1].
struct VoxelRuns {
    std::vector<Vec3i> voxels;
    std::vector<std::size_t> firstItem;  ///< voxels + 1
};
/// @param items  in the file's order
VoxelRuns findVoxels(const CacheItems& items);

/// Sky visibility: mean of n/d over the counted base regions of all items of each voxel (grid
/// `openness`).
VolumeGrid skyVisibilityGrid(const CacheHeader& header, const CacheItems& items,
                             const VoxelRuns& runs);

/// Bent normal, not normalised: mean over the same regions of n/d times the region's centre (grid
/// `open_direction`).
VolumeGrid bentNormalGrid(const CacheHeader& header, const CacheItems& items,
                          const VoxelRuns& runs);

/// Writes grids over the voxels to an OpenVDB file of their own, by way of a temporary file.
///
/// @throws Error when it cannot be written
void writeVolumes(const std::filesystem::path& path, const CacheHeader& header,
                  const std::vector<Vec3i>& voxels, const std::vector<VolumeGrid>& grids);

}  // namespace shadowcache
