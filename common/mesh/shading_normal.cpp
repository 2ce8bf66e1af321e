#include "common/mesh/shading_normal.h"

#include <algorithm>
#include <array>
#include <optional>

#include "common/mesh/placed_mesh.h"

namespace shadowcache {

namespace {

/// Unit shading normals of a triangle's corners in the world, on the side of `side`; none if a
/// corner has none.
std::optional<std::array<Vec3d, 3>> cornerNormals(const TriangleMesh& mesh, std::uint32_t number,
                                                  const Vec3f& side) noexcept {
    if (mesh.normals.empty()) return std::nullopt;
    const PlacedTriangle placed = placedTriangle(mesh, number);
    const Vec3i& corners = mesh.cornerNormals[placed.triangle];
    std::array<Vec3d, 3> normals;
    for (int k = 0; k < 3; ++k) {
        if (corners[k] < 0) return std::nullopt;
        Vec3d n(mesh.normals[static_cast<std::size_t>(corners[k])]);
        if (placed.instance) n = placed.instance->toWorld.normal(n).normalized();
        normals[static_cast<std::size_t>(k)] = n.dot(Vec3d(side)) < 0 ? -n : n;
    }
    return normals;
}

}  // namespace

Vec3f shadingNormal(const TriangleMesh& mesh, std::uint32_t number, float u, float v,
                    const Vec3f& side) noexcept {
    const auto normals = cornerNormals(mesh, number, side);
    if (!normals) return side;
    const auto& [a, b, c] = *normals;
    const Vec3d n = a * static_cast<double>(1 - u - v) + b * static_cast<double>(u) +
                    c * static_cast<double>(v);
    // Normals at a right angle to the triangle are on neither side.
    return n.dot(Vec3d(side)) > 0 ? Vec3f(n.normalized()) : side;
}

Vec3f smoothOffset(const TriangleMesh& mesh, std::uint32_t number, float u, float v,
                   const Vec3f& side) noexcept {
    const auto normals = cornerNormals(mesh, number, side);
    if (!normals) return Vec3f(0.0f);
    const std::array<Vec3d, 3> corners = placedCorners(mesh, number);
    const std::array<double, 3> weights{static_cast<double>(1 - u - v), static_cast<double>(u),
                                        static_cast<double>(v)};
    Vec3d p(0.0), offset(0.0);
    for (std::size_t k = 0; k < 3; ++k) p += corners[k] * weights[k];
    // The mean of the place's projections on the planes of the corners that it lies below.
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d& n = (*normals)[k];
        offset -= n * (weights[k] * std::min(0.0, (p - corners[k]).dot(n)));
    }
    return Vec3f(offset);
}

}  // namespace shadowcache
