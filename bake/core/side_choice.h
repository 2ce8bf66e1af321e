#pragma once

#include <bitset>
#include <vector>

#include "bake/core/patch.h"
#include "bake/core/surface_voxels.h"
#include "common/cache/patch_code.h"

namespace shadowcache {

/// What a bake makes of a voxel.
struct ChosenSides {
    std::bitset<kSides> sides;
    std::vector<Vec3f> normals;  ///< of the patches on these sides, before they are cut
};

/// Finds the sides of voxels that a selection wants: those whose items would have a share in one of
/// its lookups, and their margin.
///
/// @param seed  of the bake
/// @return by voxel's number; nothing for voxels of other shards
std::vector<ChosenSides> chooseSides(const Scene& scene, const SurfaceVoxels& voxels,
                                     const VoxelSelection& selection, std::uint64_t seed);

}  // namespace shadowcache
