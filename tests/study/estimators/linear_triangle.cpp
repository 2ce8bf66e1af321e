#include "tests/study/estimators/linear_triangle.h"

#include <algorithm>
#include <cmath>

namespace shadowcache::study {

namespace {

/// Least light at a corner of a triangle, of a mean of 1: the density must reach all of it.
constexpr double kLeastCorner = 0.1;

/// Vectors whose products with a direction w are its coordinates: w = sum of (dual_k . w) corner_k.
std::array<Vec3d, 3> dualOf(const SphericalTriangle& t, double volume) noexcept {
    return {t.b.cross(t.c) / volume, t.c.cross(t.a) / volume, t.a.cross(t.b) / volume};
}

double volumeOf(const SphericalTriangle& t) noexcept {
    return t.a.dot((t.b - t.a).cross(t.c - t.a));
}

}  // namespace

std::array<double, 3> linearShape(const SphericalTriangle& corners,
                                  const Vec3d& firstMoment) noexcept {
    // The coordinates of the first moment are the moments m_k of the light with the barycentric
    // coordinates (up to their sum over a direction, which is next to 1 in a small triangle); their
    // matrix of products over a triangle is A / 12 (1 + delta_kl), whose inverse gives 3 / A (4 m_k
    // - sum).
    const auto dual = dualOf(corners, volumeOf(corners));
    std::array<double, 3> moment{}, shape{};
    for (std::size_t k = 0; k < 3; ++k) moment[k] = dual[k].dot(firstMoment);
    const double all = moment[0] + moment[1] + moment[2];
    for (std::size_t k = 0; k < 3; ++k) shape[k] = std::max(kLeastCorner, 12 * moment[k] / all - 3);
    const double mean = (shape[0] + shape[1] + shape[2]) / 3;
    for (double& value : shape) value /= mean;
    return shape;
}

LinearTriangle::LinearTriangle(const SphericalTriangle& corners,
                               const std::array<double, 3>& values) noexcept
    : corners_{corners.a, corners.b, corners.c},
      share_(values),
      dual_(dualOf(corners, volumeOf(corners))),
      volume_(volumeOf(corners)) {
    const double sum = values[0] + values[1] + values[2];
    for (double& share : share_) share /= sum;
}

Vec3d LinearTriangle::sample(double u, double v) const noexcept {
    // A linear density is a mixture of the three barycentric coordinates. That of one corner, h,
    // has the density 6 h (1 - h) and so the distribution 3 h^2 - 2 h^3, whose inverse is closed.
    std::size_t k = 0;
    while (k < 2 && u >= share_[k]) u -= share_[k++];
    u = std::clamp(u / share_[k], 0.0, 1.0);
    const double h = 0.5 - std::sin(std::asin(1 - 2 * u) / 3);
    const Vec3d across = corners_[(k + 1) % 3] * v + corners_[(k + 2) % 3] * (1 - v);
    return (corners_[k] * h + across * (1 - h)).normalized();
}

double LinearTriangle::density(const Vec3d& direction) const noexcept {
    // The plane meets the direction at distance r = 1 / sum; it has dA = r^3 / d dw, with d its own
    // distance, and d A = volume / 2 for the area A of the flat triangle.
    double sum = 0, value = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double coordinate = dual_[k].dot(direction);
        sum += coordinate;
        value += coordinate * share_[k];
    }
    return 6 * value / (volume_ * sum * sum * sum * sum);
}

}  // namespace shadowcache::study
