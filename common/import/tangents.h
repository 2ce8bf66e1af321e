#pragma once

#include <span>
#include <vector>

#include "common/mesh/mesh.h"

namespace shadowcache {

/// Tangents of vertices that share texture coordinates, for a normal map: the mean of the
/// directions in which s grows on the triangles around, in the plane of the vertex's normal,
/// weighted by the angle at the vertex. That is what MikkTSpace makes of vertices whose triangles
/// agree in handedness; others have none.
///
/// @param normals  of the vertices, of any length; or empty: then there are none
/// @param places   texture coordinates of the vertices
/// @param corners  three vertices a triangle, out of range where there is none
std::vector<Tangent> deriveTangents(std::span<const Vec3d> positions,
                                    std::span<const Vec3d> normals, std::span<const Vec2f> places,
                                    std::span<const std::uint32_t> corners);

}  // namespace shadowcache
