#pragma once

#include <vector>

#include "bake/core/patch.h"
#include "bake/core/surface_voxels.h"
#include "common/cache/patch_code.h"

namespace shadowcache {

/// The part of a patch that lookups need, before it is cut.
struct Outline {
    int side;
    Vec3f normal;
    Vec3f position;  ///< mean point, from the voxel's middle, in spacings
};

/// The sides of a voxel that a bake makes.
struct ChosenSides {
    SideSet sides;
    std::vector<Outline> outlines;  ///< of all its patches, in their order
};

/// Finds the sides of voxels that a selection wants: those whose items would have a share in one of
/// its lookups, and their margin.
///
/// @param seed  of the bake
/// @return by voxel's number; no sides for voxels of other shards, and no outlines either for those
/// that no lookup reaches
std::vector<ChosenSides> chooseSides(const Scene& scene, const SurfaceVoxels& voxels,
                                     const VoxelSelection& selection, std::uint64_t seed);

}  // namespace shadowcache
