#include "render/paper/spherical_polygon.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace shadowcache {
namespace {

/// Where the arc from `above` to `below` meets the horizon, given the heights n . w of its ends,
/// the one positive and the other not. The combination has height 0 whatever the lengths of its
/// terms.
Vec3d horizonPoint(const Vec3d& above, const Vec3d& below, double heightAbove,
                   double heightBelow) noexcept {
    const double share = heightAbove / (heightAbove - heightBelow);
    return (above * (1.0 - share) + below * share).normalized();
}

/// Whether the piece is more than the rounding of its corners, which moves its area by their last
/// place times a side's length and may turn it inside out.
bool hasArea(const SphericalTriangle& t) noexcept {
    constexpr double kCornerRounding = 0x1p-52;
    const double limit =
        kCornerRounding *
        std::sqrt(std::max({(t.b - t.a).length2(), (t.c - t.b).length2(), (t.a - t.c).length2()}));
    const double determinant = t.a.dot((t.b - t.a).cross(t.c - t.a));
    // The area is never below half the determinant: most pieces need no arc tangent.
    return determinant > 4.0 * limit || (determinant > 0.0 && solidAngle(t) > limit);
}

void addPiece(ClippedTriangle& clipped, const SphericalTriangle& piece) noexcept {
    if (hasArea(piece)) clipped.pieces[static_cast<std::size_t>(clipped.count++)] = piece;
}

}  // namespace

ClippedTriangle clipToHemisphere(const SphericalTriangle& t, const Vec3d& n) noexcept {
    std::array<Vec3d, 3> v{t.a, t.b, t.c};
    std::array<double, 3> height{t.a.dot(n), t.b.dot(n), t.c.dot(n)};
    const auto above =
        std::count_if(height.begin(), height.end(), [](double h) { return h > 0.0; });
    ClippedTriangle clipped;
    if (above == 0) return clipped;
    if (above == 3) {
        addPiece(clipped, t);
        return clipped;
    }
    // Turn the corners until the one that differs from the other two comes first.
    const bool firstIsAbove = above == 1;
    while ((height[0] > 0.0) != firstIsAbove || (height[1] > 0.0) == firstIsAbove ||
           (height[2] > 0.0) == firstIsAbove) {
        std::rotate(v.begin(), v.begin() + 1, v.end());
        std::rotate(height.begin(), height.begin() + 1, height.end());
    }
    if (firstIsAbove) {
        addPiece(clipped, {v[0], horizonPoint(v[0], v[1], height[0], height[1]),
                           horizonPoint(v[0], v[2], height[0], height[2])});
        return clipped;
    }
    // A quadrilateral: the horizon's two points and the two corners above.
    const Vec3d p = horizonPoint(v[1], v[0], height[1], height[0]);
    const Vec3d q = horizonPoint(v[2], v[0], height[2], height[0]);
    addPiece(clipped, {p, v[1], v[2]});
    addPiece(clipped, {p, v[2], q});
    return clipped;
}

Vec3d vectorArea(const SphericalTriangle& t) noexcept {
    // Half the sum over the sides of arc length times the unit normal of the side's plane.
    const std::array<const Vec3d*, 4> v{&t.a, &t.b, &t.c, &t.a};
    Vec3d sum(0.0);
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d normal = v[i]->cross(*v[i + 1] - *v[i]);
        const double sine = normal.length();
        if (sine > 0.0) sum += normal * (std::atan2(sine, v[i]->dot(*v[i + 1])) / sine);
    }
    return sum * 0.5;
}

}  // namespace shadowcache
