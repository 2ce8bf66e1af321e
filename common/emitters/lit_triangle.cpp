#include "common/emitters/lit_triangle.h"

#include <algorithm>
#include <cmath>

#include "common/math/angle.h"

namespace shadowcache {

LitPolygon aboveHorizon(const std::array<Vec3d, 3>& triangle, const Vec3d& n) noexcept {
    LitPolygon out;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d &a = triangle[i], &b = triangle[(i + 1) % 3];
        const double heightA = n.dot(a), heightB = n.dot(b);
        if (heightA > 0) out.corner[static_cast<std::size_t>(out.corners++)] = a;
        if ((heightA > 0) != (heightB > 0))
            out.corner[static_cast<std::size_t>(out.corners++)] =
                a + (b - a) * (heightA / (heightA - heightB));
    }
    return out;
}

double cosineIntegral(const LitPolygon& polygon, const Vec3d& n) noexcept {
    double sum = 0;
    for (int i = 0; i < polygon.corners; ++i) {
        const Vec3d& a = polygon.corner[static_cast<std::size_t>(i)];
        const Vec3d& b = polygon.corner[static_cast<std::size_t>((i + 1) % polygon.corners)];
        // From the difference, which does not cancel where corners are near each other.
        const Vec3d across = a.cross(b - a);
        const double sine = across.length();
        if (sine > 0) sum += angleOf(sine, a.dot(b)) * (n.dot(across) / sine);
    }
    return std::clamp(0.5 * std::abs(sum), 0.0, kPi);
}

LitPolygonSampler::LitPolygonSampler(const LitPolygon& polygon) noexcept {
    std::array<Vec3d, 4> d{};
    for (int i = 0; i < polygon.corners; ++i) {
        const auto k = static_cast<std::size_t>(i);
        d[k] = polygon.corner[k].normalized();
    }
    for (std::size_t k = 0; static_cast<int>(k) + 2 < polygon.corners; ++k) {
        part_[k] = {d[0], d[k + 1], d[k + 2]};
        // Counter-clockwise as the place sees it from outside.
        if (d[0].dot((d[k + 1] - d[0]).cross(d[k + 2] - d[0])) < 0)
            std::swap(part_[k].b, part_[k].c);
        area_[k] = shadowcache::solidAngle(part_[k]);
    }
}

Vec3d LitPolygonSampler::sample(double u, double v) const noexcept {
    const double at = u * solidAngle();
    const bool second = at >= area_[0] && area_[1] > 0;
    const std::size_t k = second ? 1 : 0;
    const double within = (second ? at - area_[0] : at) / area_[k];
    return sampleDirection(part_[k], std::min(within, 1 - 0x1p-53), v);
}

}  // namespace shadowcache
