#pragma once

#include <cstddef>

#include "bake/core/placement.h"

namespace shadowcache {

/// How much of a set's surface there is, in voxels.
struct SurfaceCount {
    std::size_t voxels = 0;  ///< that hold surface
    std::size_t sides = 0;   ///< of all of them, that hold items of a whole bake
    std::size_t items = 0;   ///< about: two for each axis that normals of a voxel's surface lean to
};

/// Without memory for each triangle in each voxel.
SurfaceCount countSurface(const TriangleMesh& mesh, const VoxelFrame& frame);

}  // namespace shadowcache
