#pragma once

#include <algorithm>
#include <cmath>

#include "common/math/vec.h"

namespace shadowcache {

/// An azimuth v in [0, 1) becomes a direction around `n` whose cosine is `cosTheta`: uniform over
/// the hemisphere if that is uniform in [0, 1).
inline Vec3f aroundNormal(const Vec3f& n, float cosTheta, float v) {
    Vec3f s, t;
    tangentFrame(n, s, t);
    const float sinTheta = std::sqrt(std::max(0.0f, 1 - cosTheta * cosTheta));
    const float phi = 2 * static_cast<float>(kPi) * v;
    return s * (sinTheta * std::cos(phi)) + t * (sinTheta * std::sin(phi)) + n * cosTheta;
}

}  // namespace shadowcache
