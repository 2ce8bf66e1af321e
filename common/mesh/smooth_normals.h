#pragma once

#include "common/mesh/mesh.h"

namespace shadowcache {

/// Gives shading normals to the triangles that have none. The normal of a corner is the mean,
/// weighted by the angle at the corner [Thürmer & Wüthrich 1998], of the triangles there whose
/// geometric normals are at most `degrees` (0 to 180) from that of its own. Vertices at one place
/// count as one. Triangles of opposite winding are on opposite sides, so that they smooth nothing
/// together. Flat neighbourhoods keep their geometric normals.
void smoothNormals(TriangleMesh& mesh, double degrees);

}  // namespace shadowcache
