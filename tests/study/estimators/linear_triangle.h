#pragma once

#include <array>

#include "common/math/spherical_triangle.h"

namespace shadowcache::study {

/// Values at the corners, mean 1, of the linear function over a triangle that is next to its light
/// in the mean square, but nowhere below a tenth of the mean.
///
/// @param firstMoment  integral of luminance times direction over the triangle, not 0
std::array<double, 3> linearShape(const SphericalTriangle& corners,
                                  const Vec3d& firstMoment) noexcept;

/// Density over the directions in a spherical triangle that is linear over the plane through its
/// corners.
class LinearTriangle {
public:
    /// @param values  in proportion to the density at the corners, all positive
    LinearTriangle(const SphericalTriangle& corners, const std::array<double, 3>& values) noexcept;

    /// Direction for (u, v) in [0, 1)^2.
    Vec3d sample(double u, double v) const noexcept;

    /// With which sample() draws a direction in the triangle [1/sr].
    double density(const Vec3d& direction) const noexcept;

private:
    std::array<Vec3d, 3> corners_;
    std::array<double, 3> share_;  ///< of the corners' values, sum 1
    std::array<Vec3d, 3> dual_;    ///< dual_[k] . w: how much of corner k is in w
    double volume_;                ///< determinant of the corners
};

}  // namespace shadowcache::study
