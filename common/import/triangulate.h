#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/vec.h"

namespace shadowcache {

/// Most corners of a concave face that is still cut into triangles; the time grows with the square.
inline constexpr std::size_t kMaxConcaveCorners = 20000;

/// Cuts a polygon of n >= 3 corners into exactly n - 2 triangles of its winding, appended to `out`
/// as places in `corners`; concave polygons in a plane are covered once. Non-planar ones are cut as
/// their projection along the mean normal; self-crossing ones are cut somehow.
///
/// @return false, with nothing appended, if it is concave with more than kMaxConcaveCorners corners
bool triangulate(std::span<const Vec3d> corners, std::vector<std::array<std::uint32_t, 3>>& out);

}  // namespace shadowcache
