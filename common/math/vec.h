#pragma once

#include <Imath/ImathBox.h>
#include <Imath/ImathColor.h>
#include <Imath/ImathVec.h>

namespace shadowcache {

/// Direction, or offset, in single precision.
using Vec3f = Imath::V3f;
/// Position, or direction, in double precision.
using Vec3d = Imath::V3d;
/// Voxel.
using Vec3i = Imath::V3i;
/// Axis-aligned box.
using Box3d = Imath::Box3d;
/// Linear RGB radiance, irradiance or albedo.
using Rgb = Imath::C3f;

/// Ratio of a circle's circumference to its diameter.
inline constexpr double kPi = 3.14159265358979323846;

/// Rec. 709 luminance of linear RGB.
inline float luminance(const Rgb& c) {
    return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}

/// Two unit vectors that complete the unit vector `n` to a right-handed basis (s, t, n).
///
/// Source: Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
template <class T>
void tangentFrame(const Imath::Vec3<T>& n, Imath::Vec3<T>& s, Imath::Vec3<T>& t) {
    const T sign = n.z >= T(0) ? T(1) : T(-1);
    const T a = T(-1) / (sign + n.z);
    const T b = n.x * n.y * a;
    s = {T(1) + sign * n.x * n.x * a, sign * b, -sign * n.x};
    t = {b, sign + n.y * n.y * a, -n.y};
}

}  // namespace shadowcache
