#pragma once

#include <array>

#include "common/math/spherical_triangle.h"

namespace shadowcache {

/// What is left of a spherical triangle above a horizon: none, one or two triangles that do not
/// overlap.
struct ClippedTriangle {
    std::array<SphericalTriangle, 2> pieces;
    int count = 0;
};

/// Part of `t` in the open hemisphere {w : w . n > 0}; slivers of no area are left out.
///
/// @param n unit normal
///
/// Source: [paper, appendix A].
ClippedTriangle clipToHemisphere(const SphericalTriangle& t, const Vec3d& n) noexcept;

/// Integral of the direction over `t` as a vector [sr]; its dot product with n is the
/// cosine-weighted area when `t` lies wholly above the horizon of n. [Arvo 1995, "Applications of
/// irradiance tensors"]
Vec3d vectorArea(const SphericalTriangle& t) noexcept;

}  // namespace shadowcache
