#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "common/math/vec.h"

namespace shadowcache {

/// Places on surfaces, as callers have them.
struct Places {
    std::span<const Vec3d> positions;  ///< world space
    std::span<const Vec3d> normals;    ///< as many; of any length, towards the side that is lit

    std::size_t size() const { return positions.size(); }
};

/// Whether a vector is a direction: finite, and not 0.
inline bool isDirection(const Vec3d& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && v != Vec3d(0.0);
}

/// Whether place i is one: a finite position, and a normal that is a direction.
inline bool isPlace(const Places& places, std::size_t i) {
    const Vec3d& at = places.positions[i];
    return std::isfinite(at.x) && std::isfinite(at.y) && std::isfinite(at.z) &&
           isDirection(places.normals[i]);
}

/// Unit vector along a direction, however long.
inline Vec3d unitAlong(const Vec3d& v) {
    const double most = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    return (v / most).normalized();
}

}  // namespace shadowcache
