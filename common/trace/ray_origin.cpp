// Where rays off a surface begin.

#include <algorithm>
#include <array>
#include <cmath>

#include "common/mesh/placed_mesh.h"
#include "common/trace/scene.h"

namespace shadowcache {

namespace {

float maxAbs(const Vec3f& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// Unit roundoffs by which rays are moved: what planeRounding() counts happens up to 15 times on
/// the way to Embree's verdict, on which side of a triangle a ray begins.
constexpr double kRoundings = 0x1p-19;

Vec3d magnitude(const Vec3d& v) {
    return {std::abs(v.x), std::abs(v.y), std::abs(v.z)};
}

/// What is rounded off of the distance from a place to the plane of a triangle, in unit roundoffs,
/// when Embree computes it in float: the corners relative to the place, the normal from two edges,
/// and their product. Along each axis for itself: a floor has no coordinates of its height, however
/// far it reaches. [Higham 2002, Sec. 3.1; Wächter & Binder 2019]
///
/// @param place      in the space of the triangle
/// @param magnitude  of what is rounded off of the place, by axis
/// @return times the length of the normal (b - a) x (c - a)
double planeRounding(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& place,
                     const Vec3d& magnitude) {
    const Vec3d normal = (b - a).cross(c - a);
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const double far = std::max(
            {std::abs(a[k] - place[k]), std::abs(b[k] - place[k]), std::abs(c[k] - place[k])});
        // Of the two products of a component of the normal.
        const double product = std::max(
            {std::abs((b[i] - a[i]) * (c[j] - a[j])), std::abs((b[j] - a[j]) * (c[i] - a[i]))});
        sum += std::abs(normal[k]) * (magnitude[k] + far) + far * product;
    }
    return sum;
}

/// The same as a distance, of a triangle of the world.
double planeRounding(const std::array<Vec3d, 3>& corners, const Vec3d& place,
                     const Vec3d& magnitude) {
    const auto& [a, b, c] = corners;
    return planeRounding(a, b, c, place, magnitude) / (b - a).cross(c - a).length();
}

/// The same of an instance's, whose rays are brought into its space.
///
/// @param place  in the world
double planeRounding(const std::array<Vec3d, 3>& corners, const Affine& toWorld,
                     const Vec3d& place) {
    const auto& [a, b, c] = corners;
    const auto& [x, y, z] = toWorld.axis;
    const double determinant = toWorld.determinant();
    const std::array<Vec3d, 3> inverse{y.cross(z) / determinant, z.cross(x) / determinant,
                                       x.cross(y) / determinant};  // its rows
    const Vec3d at = place - toWorld.position;
    const Vec3d local(inverse[0].dot(at), inverse[1].dot(at), inverse[2].dot(at));
    const Vec3d world = magnitude(place) + magnitude(toWorld.position) + magnitude(x * local.x) +
                        magnitude(y * local.y) + magnitude(z * local.z);
    const Vec3d rounded(magnitude(inverse[0]).dot(world), magnitude(inverse[1]).dot(world),
                        magnitude(inverse[2]).dot(world));
    // A distance along a normal n of the space is n . d / |n| there, and n . d / |n'| in the world.
    const Vec3d n = (b - a).cross(c - a);
    const Vec3d image = inverse[0] * n.x + inverse[1] * n.y + inverse[2] * n.z;
    return planeRounding(a, b, c, local, rounded) / image.length();
}

/// Largest number that takes part in placing `p`, and in bringing rays back to it: what is rounded
/// off is in proportion.
float roundingScale(const Affine& map, const Vec3f& p) {
    double scale = static_cast<double>(maxAbs(Vec3f(map.position)));
    for (int k = 0; k < 3; ++k)
        scale +=
            map.axis[static_cast<std::size_t>(k)].length() * std::abs(static_cast<double>(p[k]));
    return static_cast<float>(2 * scale);
}

}  // namespace

Vec3f Scene::rayOrigin(const Vec3f& position, std::uint32_t triangle,
                       const Vec3f& side) const noexcept {
    const PlacedTriangle placed = placedTriangle(mesh_, triangle);
    const Vec3i& t = mesh_.triangles[placed.triangle];
    std::array<Vec3d, 3> corners;
    float scale = 0;
    for (int k = 0; k < 3; ++k) {
        const Vec3f& p = mesh_.positions[static_cast<std::size_t>(t[k])];
        corners[static_cast<std::size_t>(k)] = Vec3d(p);
        scale = std::max(scale,
                         placed.instance ? roundingScale(placed.instance->toWorld, p) : maxAbs(p));
    }
    // Of a plane through the origin along axes nothing is rounded off, but a ray must begin beside.
    constexpr double kLeast = 0x1p-40;
    const double most = static_cast<double>(scale);
    const double bound = placed.instance
                             ? planeRounding(corners, placed.instance->toWorld, Vec3d(position))
                             : planeRounding(corners, Vec3d(position), magnitude(Vec3d(position)));
    return position +
           side * static_cast<float>(kRoundings * std::clamp(bound, kLeast * most, most));
}

}  // namespace shadowcache
