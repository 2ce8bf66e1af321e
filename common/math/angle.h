#pragma once

#include <cmath>
#include <numbers>

namespace shadowcache {

/// std::atan2(y, x) of a y that is not negative, within 1e-12 of itself, and faster:
/// without branches. 0 where the sum of their squares is 0.
inline double angleOf(double y, double x) noexcept {
    // Of half the angle of (|x|, y), 0 to pi / 4: the tangent, less that of pi / 8 where it is
    // above it.
    const double length = std::sqrt(x * x + y * y) + std::abs(x);
    const double half = length > 0 ? y / length : 0;
    constexpr double kTanEighth = std::numbers::sqrt2 - 1;
    const bool wide = half > kTanEighth;
    const double t = wide ? (half - 1) / (half + 1) : half;
    // atan(t) / t by t^2, interpolated at the zeros of Chebyshev's polynomial.
    const double s = t * t;
    double series = -0.03765497809155596;
    series = series * s + 0.06974189893654982;
    series = series * s - 0.0899255102891737;
    series = series * s + 0.1110345668199251;
    series = series * s - 0.14285386539317588;
    series = series * s + 0.1999999305309275;
    series = series * s - 0.33333333276915994;
    series = series * s + 0.9999999999992446;
    const double sharp = 2 * (t * series + (wide ? 0.25 * std::numbers::pi : 0));
    return x < 0 ? std::numbers::pi - sharp : sharp;
}

}  // namespace shadowcache
