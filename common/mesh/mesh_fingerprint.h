#pragma once

#include <cstdint>

#include "common/mesh/mesh.h"

namespace shadowcache {

/// Hash of the triangles' world positions, independent of vertex order; two sets with the same
/// fingerprint have the same visibility, holes of cut-out materials included.
std::uint64_t fingerprint(const TriangleMesh& mesh);

}  // namespace shadowcache
