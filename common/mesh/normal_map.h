#pragma once

#include <cstdint>

#include "common/mesh/mesh.h"

namespace shadowcache {

/// Unit normal of a normal map at barycentric coordinates of a triangle of the world
/// (placed_mesh.h): in the basis of the tangents of the corners, interpolated, or, where a corner
/// has none, of the triangle's own texture coordinates.
///
/// @param side     unit geometric normal of the triangle, on the side that is seen
/// @param shading  unit shading normal there (shading_normal.h)
/// @return         on the same side; `shading` itself where there is no map, where the texture
///                 coordinates span no basis, and where the map's normal is on the other side
Vec3f mappedNormal(const TriangleMesh& mesh, std::uint32_t number, float u, float v,
                   const Vec3f& side, const Vec3f& shading) noexcept;

}  // namespace shadowcache
