#pragma once

#include <array>
#include <cmath>

#include "common/math/vec.h"

namespace shadowcache {

/// Orthogonal map of directions: a rotation, or a rotation and a reflection.
struct Turn {
    std::array<Vec3d, 3> axis{Vec3d(1, 0, 0), Vec3d(0, 1, 0),
                              Vec3d(0, 0, 1)};  ///< images of x, y, z: the matrix's columns

    Vec3d apply(const Vec3d& v) const { return axis[0] * v.x + axis[1] * v.y + axis[2] * v.z; }
    Vec3d undo(const Vec3d& v) const { return {axis[0].dot(v), axis[1].dot(v), axis[2].dot(v)}; }

    bool operator==(const Turn&) const = default;
};

/// Turns about the fixed axes +X, then +Y, then +Z (Euler angles XYZ), each counter-clockwise for
/// who looks against the axis.
inline Turn turnByAngles(const Vec3d& degrees) {
    const Vec3d angle = degrees * (kPi / 180);
    const Vec3d c(std::cos(angle.x), std::cos(angle.y), std::cos(angle.z));
    const Vec3d s(std::sin(angle.x), std::sin(angle.y), std::sin(angle.z));
    return {{Vec3d(c.y * c.z, c.y * s.z, -s.y),
             Vec3d(s.x * s.y * c.z - c.x * s.z, s.x * s.y * s.z + c.x * c.z, s.x * c.y),
             Vec3d(c.x * s.y * c.z + s.x * s.z, c.x * s.y * s.z - s.x * c.z, c.x * c.y)}};
}

}  // namespace shadowcache
