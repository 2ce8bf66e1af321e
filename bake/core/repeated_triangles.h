#pragma once

#include <vector>

#include "common/mesh/mesh.h"

namespace shadowcache {

/// By triangle that stands in the world directly: whether it repeats an earlier one, corner for
/// corner and with the same material. A copy adds no surface: it is neither counted nor cut
/// into voxels. Some sets hold hundreds of copies of a face.
///
/// @return empty if the mesh's report counts no duplicates
std::vector<bool> repeatedTriangles(const TriangleMesh& mesh);

}  // namespace shadowcache
