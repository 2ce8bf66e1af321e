#pragma once

#include <algorithm>
#include <cmath>

#include "common/math/vec.h"

namespace shadowcache {

/// Largest coordinate of a set, a camera or a moving object, in world units. Embree accepts rays
/// and triangles up to 1.8e18, also in the space of an instance: what is within this can be brought
/// there through any kMostInverse. Six times the distance from the earth to the sun in metres.
inline constexpr double kMostCoordinate = 1e12;

/// Largest factor by which an instance's inverse may lengthen: scales below 2e-6 are refused.
inline constexpr double kMostInverse = 5e5;

/// Largest height of an orthographic view: the widest frame, 65536 x 1, stays in Embree's range.
inline constexpr double kMostViewHeight = 1e7;

/// Whether a place is finite and within kMostCoordinate.
inline bool isInReach(const Vec3d& p) noexcept {
    // Written so that NaN fails.
    return std::abs(p.x) <= kMostCoordinate && std::abs(p.y) <= kMostCoordinate &&
           std::abs(p.z) <= kMostCoordinate;
}

}  // namespace shadowcache
