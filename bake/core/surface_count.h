#pragma once

#include <cstddef>

#include "bake/core/placement.h"

namespace shadowcache {

/// How much of a set's surface there is, in voxels.
struct SurfaceCount {
    std::size_t voxels = 0;  ///< voxels that hold surface
    std::size_t sides = 0;   ///< sides of these voxels that have items in a whole bake
    std::size_t items =
        0;  ///< estimated: two for each axis that normals of a voxel's surface lean to
};

/// Needs no memory for each triangle in each voxel.
SurfaceCount countSurface(const TriangleMesh& mesh, const VoxelFrame& frame);

}  // namespace shadowcache
