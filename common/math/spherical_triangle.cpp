#include "common/math/spherical_triangle.h"

#include <algorithm>
#include <cmath>

namespace shadowcache {
namespace {

/// Six times the volume of the tetrahedron (0, a, b, c), from differences: nearby corners do not
/// cancel.
double determinant(const SphericalTriangle& t) noexcept {
    return t.a.dot((t.b - t.a).cross(t.c - t.a));
}

/// Quantities of Arvo's map that depend on the triangle alone. The sub-triangle (a, b, c'), with c'
/// on the side from a to c at the angle theta from a, has the area E with
///
///     tan(E / 2) = sine * h / (1 + a.b + slope * h),   h = tan(theta / 2),
///
/// which follows from [Van Oosterom & Strackee 1983] for c' = a cos(theta) + tangent sin(theta). It
/// is Arvo's relation without his differences of cosines, which cancel in small triangles, and it
/// is inverted by one division.
struct ArvoMap {
    Vec3d tangent;  ///< unit tangent at a toward c; 0 if a = c
    double sine;    ///< det(a, b, tangent)
    double slope;   ///< b . tangent
    double base;    ///< 1 + a . b
    double halfArea;
};

ArvoMap arvoMap(const SphericalTriangle& t) noexcept {
    const Vec3d normal = t.a.cross(t.c - t.a);
    const double sinAC = normal.length();
    if (!(sinAC > 0.0)) return {Vec3d(0.0), 0.0, 0.0, 1.0 + t.a.dot(t.b), 0.0};
    ArvoMap map{};
    map.tangent = normal.cross(t.a) / sinAC;
    // From the determinant that gives the area: whatever its rounding in a sliver, u0 = 1 meets c.
    map.sine = std::abs(determinant(t)) / sinAC;
    map.slope = (t.b - t.a).dot(map.tangent);
    map.base = 1.0 + t.a.dot(t.b);
    map.halfArea = 0.5 * solidAngle(t);
    return map;
}

/// c' - a for h = tan(theta / 2), free of cancellation.
Vec3d alongSide(const SphericalTriangle& t, const ArvoMap& map, double h) noexcept {
    return (map.tangent - t.a * h) * (2.0 * h / (1.0 + h * h));
}

}  // namespace

double solidAngle(const SphericalTriangle& t) noexcept {
    return 2.0 *
           std::atan2(std::abs(determinant(t)), 1.0 + t.a.dot(t.b) + t.b.dot(t.c) + t.c.dot(t.a));
}

bool contains(const SphericalTriangle& t, const Vec3d& direction) noexcept {
    // A direction rounded to double leaves its side by about one ulp; four are let pass.
    constexpr double kTolerance = 4 * 0x1p-52;
    const auto inside = [&](const Vec3d& from, const Vec3d& to) {
        const Vec3d side = to - from;
        return direction.dot(from.cross(side)) >= -kTolerance * side.length();
    };
    return inside(t.a, t.b) && inside(t.b, t.c) && inside(t.c, t.a);
}

Vec3d sampleDirection(const SphericalTriangle& t, double u0, double u1) noexcept {
    const ArvoMap map = arvoMap(t);
    const double sinE = std::sin(u0 * map.halfArea);
    const double cosE = std::cos(u0 * map.halfArea);
    const double numerator = sinE * map.base;
    const double denominator = map.sine * cosE - map.slope * sinE;
    const double h = denominator > 0.0 ? numerator / denominator : 0.0;

    // The point at the fraction u1 of the height 1 - cos of the arc from b to c'.
    const Vec3d chord = (t.a - t.b) + alongSide(t, map, h);
    const Vec3d normal = t.b.cross(chord);
    const double sinBC = normal.length();
    if (!(sinBC > 0.0)) return t.b;
    const double height = u1 * 0.5 * chord.length2();
    const double radius = std::sqrt(std::max(0.0, height * (2.0 - height)));
    return t.b + (normal.cross(t.b) * (radius / sinBC) - t.b * height);
}

Imath::V2d invertSample(const SphericalTriangle& t, const Vec3d& direction) noexcept {
    constexpr double kBelowOne = 1.0 - 0x1p-53;
    const ArvoMap map = arvoMap(t);
    const Vec3d chord = direction - t.b;
    // c' lies where the great circle through b and the direction meets the side from a to c:
    // normal . (a cos(theta) + tangent sin(theta)) = 0.
    const Vec3d normal = t.b.cross(chord);
    const double y = std::max(0.0, normal.dot(t.a - t.b));
    const double x = -normal.dot(map.tangent);
    const double r = std::hypot(x, y);
    if (!(r > 0.0) || !(map.halfArea > 0.0)) return {0.0, 0.0};
    const double h = x > 0.0 ? y / (r + x) : (r - x) / std::max(y, 0x1p-1000);
    const double u0 = std::atan2(map.sine * h, map.base + map.slope * h) / map.halfArea;
    const double full = ((t.a - t.b) + alongSide(t, map, h)).length2();
    const double u1 = full > 0.0 ? chord.length2() / full : 0.0;
    return {std::clamp(u0, 0.0, kBelowOne), std::clamp(u1, 0.0, kBelowOne)};
}

}  // namespace shadowcache
