#pragma once

#include <cstdint>

#include "common/mesh/mesh.h"

namespace shadowcache {

/// Hash of all that a bake depends on: the triangles' world positions, independent of the order of
/// triangles and vertices; which of their sides are seen; and their holes, as materials cut them
/// out.
std::uint64_t fingerprint(const TriangleMesh& mesh);

}  // namespace shadowcache
