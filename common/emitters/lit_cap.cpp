#include "common/emitters/lit_cap.h"

#include <algorithm>
#include <cmath>

namespace shadowcache {

namespace {

/// 1 minus the cosine of a cap's angle, without cancellation.
double heightOf(double sineSquared) {
    return sineSquared / (1 + std::sqrt(std::max(0.0, 1 - sineSquared)));
}

}  // namespace

double capCosine(double cosine, double sineSquared) noexcept {
    if (cosine * std::abs(cosine) >= sineSquared) return cosine;
    if (sineSquared == 0 || cosine * std::abs(cosine) <= -sineSquared) return 0;
    const double cotangent = std::sqrt(1 / sineSquared - 1);
    const double sine = std::sqrt(1 - cosine * cosine);
    const double y = std::clamp(-cotangent * cosine / sine, -1.0, 1.0);
    const double across = sine * std::sqrt(1 - y * y);
    const double integral =
        (cosine * std::acos(y) - cotangent * across) * sineSquared + std::atan2(across, cotangent);
    // However little is above the horizon, a sample may meet it.
    return std::max(integral / (kPi * sineSquared), 1e-9);
}

double capSolidAngle(double sineSquared) noexcept {
    return 2 * kPi * heightOf(sineSquared);
}

Vec3d sampleCap(const Vec3d& axis, double sineSquared, double u, double v) noexcept {
    const double height = u * heightOf(sineSquared);
    const double sine = std::sqrt(height * (2 - height)), turn = 2 * kPi * v;
    Vec3d s, t;
    tangentFrame(axis, s, t);
    return s * (sine * std::cos(turn)) + t * (sine * std::sin(turn)) + axis * (1 - height);
}

bool isInCap(const Vec3d& axis, double sineSquared, const Vec3d& direction) noexcept {
    return axis.dot(direction) > 0 && axis.cross(direction).length2() <= sineSquared;
}

}  // namespace shadowcache
