#pragma once

#include <vector>

#include "common/mesh/mesh.h"

namespace shadowcache {

/// By triangle that stands in the world directly: whether it repeats an earlier one, corner for
/// corner and with the same material. Its surface is then that of the other, and is not to be
/// counted or cut into voxels again: some sets hold hundreds of copies of a face.
///
/// @return empty if the mesh's report counts no duplicates
std::vector<bool> repeatedTriangles(const TriangleMesh& mesh);

}  // namespace shadowcache
