#pragma once

#include "common/math/vec.h"

namespace shadowcache {

/// Spherical triangle with unit-vector corners in counter-clockwise order seen from outside; each
/// side shorter than a half circle.
struct SphericalTriangle {
    Vec3d a, b, c;  ///< unit vectors
};

/// Solid angle in steradians; stays accurate to 3e-7 (relative) at level 9 of the direction mesh,
/// where the sum of angles is 27 % wrong in float. [Van Oosterom & Strackee 1983]
double solidAngle(const SphericalTriangle& t) noexcept;

/// Whether the unit vector `direction` lies in `t`, sides included.
bool contains(const SphericalTriangle& t, const Vec3d& direction) noexcept;

/// Direction distributed uniformly in solid angle over `t`; its density is 1 / solidAngle(t).
///
/// @param t   non-degenerate triangle (solidAngle(t) > 0)
/// @param u0  chooses the sub-area, in [0, 1)
/// @param u1  chooses the height along the arc, in [0, 1)
/// @return    unit vector inside `t`
///
/// Source: Arvo 1995, "Stratified Sampling of Spherical Triangles".
Vec3d sampleDirection(const SphericalTriangle& t, double u0, double u1) noexcept;

/// The (u0, u1) that sampleDirection maps to `direction`, which must lie in `t`. [Arvo 1995]
Imath::V2d invertSample(const SphericalTriangle& t, const Vec3d& direction) noexcept;

}  // namespace shadowcache
