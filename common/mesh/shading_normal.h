#pragma once

#include <cstdint>

#include "common/mesh/mesh.h"

namespace shadowcache {

/// Unit shading normal at barycentric coordinates of a triangle of the world (placed_mesh.h): those
/// of the corners, interpolated.
///
/// @param side  unit geometric normal of the triangle, on the side that is seen
/// @return      on the same side; `side` itself where a corner has no shading normal
Vec3f shadingNormal(const TriangleMesh& mesh, std::uint32_t number, float u, float v,
                    const Vec3f& side) noexcept;

/// From there to the smooth surface that the shading normals of a convex part stand for: where
/// shadow rays start, so that facets cast no shadow on themselves [Hanika 2021, "Hacking the Shadow
/// Terminator"]. 0 where a corner has no shading normal, and on flat and concave parts.
///
/// @param side  as above
Vec3f smoothOffset(const TriangleMesh& mesh, std::uint32_t number, float u, float v,
                   const Vec3f& side) noexcept;

}  // namespace shadowcache
