#pragma once

#include "common/mesh/mesh.h"

namespace shadowcache {

/// Least spacing of the voxels of a mesh, whose numbers must fit their keys (VoxelFrame).
double leastSpacing(const TriangleMesh& mesh);

}  // namespace shadowcache
