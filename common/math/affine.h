#pragma once

#include <array>
#include <cmath>

#include "common/math/vec.h"

namespace shadowcache {

/// Affine map of space.
struct Affine {
    std::array<Vec3d, 3> axis{Vec3d(1, 0, 0), Vec3d(0, 1, 0),
                              Vec3d(0, 0, 1)};  ///< images of x, y, z
    Vec3d position{0, 0, 0};                    ///< image of 0

    Vec3d vector(const Vec3d& v) const { return axis[0] * v.x + axis[1] * v.y + axis[2] * v.z; }
    Vec3d point(const Vec3d& p) const { return vector(p) + position; }
    /// Image of a surface's normal; not of unit length, and 0 if the map flattens the surface.
    Vec3d normal(const Vec3d& n) const {
        const Vec3d image = axis[1].cross(axis[2]) * n.x + axis[2].cross(axis[0]) * n.y +
                            axis[0].cross(axis[1]) * n.z;
        return mirrors() ? -image : image;
    }
    double determinant() const { return axis[0].dot(axis[1].cross(axis[2])); }
    /// Whether it turns left into right; the order of a triangle's corners then tells its wrong
    /// side.
    bool mirrors() const { return determinant() < 0; }

    /// Whether rays can be brought back through it: not when it flattens what it maps.
    bool invertible() const {
        const double size = axis[0].length() * axis[1].length() * axis[2].length();
        return std::abs(determinant()) > 1e-6 * size;
    }

    bool isFinite() const {
        double sum = 0;
        for (const Vec3d& v : {axis[0], axis[1], axis[2], position})
            sum += std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
        return std::isfinite(sum);
    }
};

/// `inner` first, then `outer`.
inline Affine compose(const Affine& outer, const Affine& inner) {
    return {{outer.vector(inner.axis[0]), outer.vector(inner.axis[1]), outer.vector(inner.axis[2])},
            outer.point(inner.position)};
}

}  // namespace shadowcache
