#pragma once

#include "common/mesh/mesh.h"

namespace shadowcache {

/// Fills in duplicates, nonManifoldEdges and mixedWinding of the mesh's report. Vertices at one
/// position count as one, since many formats repeat them along seams.
void countDefects(TriangleMesh& mesh);

}  // namespace shadowcache
