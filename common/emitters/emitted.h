#pragma once

#include <cstdint>

#include "common/mesh/mesh.h"

namespace shadowcache {

/// Radiance of a triangle of a mesh at barycentric coordinates.
///
/// @param triangle  of TriangleMesh::triangles, with a material
Rgb emittedAt(const TriangleMesh& mesh, std::uint32_t triangle, float u, float v) noexcept;

}  // namespace shadowcache
