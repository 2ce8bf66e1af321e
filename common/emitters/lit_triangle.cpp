#include "common/emitters/lit_triangle.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "common/math/angle.h"

namespace shadowcache {

namespace {

LitPolygon clip(std::span<const Vec3d> corner, const Vec3d& n) {
    LitPolygon out;
    // Of what is convex but for rounding, more than there is room for are alike.
    const auto add = [&out](const Vec3d& c) {
        if (out.corners < LitPolygon::kMostCorners)
            out.corner[static_cast<std::size_t>(out.corners++)] = c;
    };
    for (std::size_t i = 0; i < corner.size(); ++i) {
        const Vec3d &a = corner[i], &b = corner[i + 1 < corner.size() ? i + 1 : 0];
        const double heightA = n.dot(a), heightB = n.dot(b);
        if (heightA > 0) add(a);
        if ((heightA > 0) != (heightB > 0)) add(a + (b - a) * (heightA / (heightA - heightB)));
    }
    return out;
}

}  // namespace

LitPolygon aboveHorizon(const std::array<Vec3d, 3>& triangle, const Vec3d& n) noexcept {
    return clip(triangle, n);
}

LitPolygon clipped(const LitPolygon& polygon, const Vec3d& n) noexcept {
    return clip(std::span(polygon.corner).first(static_cast<std::size_t>(polygon.corners)), n);
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
    std::array<Vec3d, LitPolygon::kMostCorners> d{};
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
        solidAngle_ += area_[k];
        ++parts_;
    }
}

Vec3d LitPolygonSampler::sample(double u, double v) const noexcept {
    double rest = u * solidAngle_;
    std::size_t k = 0, last = 0;
    for (; k < parts_; ++k) {
        if (area_[k] > 0) last = k;
        if (rest < area_[k]) break;
        rest -= area_[k];
    }
    // Rounding may leave something behind the last one.
    if (k == parts_) k = last;
    return sampleDirection(part_[k], std::clamp(rest / area_[k], 0.0, 1 - 0x1p-53), v);
}

}  // namespace shadowcache
