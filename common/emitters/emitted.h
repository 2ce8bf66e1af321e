#pragma once

#include <algorithm>
#include <cstdint>

#include "common/mesh/mesh.h"

namespace shadowcache {

/// Radiance of a triangle of a mesh at barycentric coordinates.
///
/// @param triangle  of TriangleMesh::triangles, with a material
Rgb emittedAt(const TriangleMesh& mesh, std::uint32_t triangle, float u, float v) noexcept;

/// Luminance of what is emitted; what is less than none counts as none.
inline float brightness(const Rgb& emitted) noexcept {
    return std::max(0.0f, luminance(emitted));
}

}  // namespace shadowcache
