#include "common/mesh/normal_map.h"

#include <cmath>
#include <optional>

#include "common/mesh/looks.h"
#include "common/mesh/placed_mesh.h"

namespace shadowcache {

namespace {

/// Where a texture's s grows, in the world, and on which side of it t falls.
struct TangentAt {
    Vec3d direction;
    double side;  ///< 1 or -1, times normal x direction: up in the picture
};

std::optional<TangentAt> interpolated(const TriangleMesh& mesh, const PlacedTriangle& placed,
                                      float u, float v) {
    if (mesh.tangents.empty()) return std::nullopt;
    const Vec3i& corners = mesh.triangles[placed.triangle];
    const float weights[3] = {1 - u - v, u, v};
    TangentAt sum{Vec3d(0.0), 0};
    for (int k = 0; k < 3; ++k) {
        const Tangent& tangent = mesh.tangents[static_cast<std::size_t>(corners[k])];
        if (tangent.side == 0 || (k > 0 && static_cast<double>(tangent.side) != sum.side))
            return std::nullopt;
        sum.side = static_cast<double>(tangent.side);
        sum.direction += Vec3d(tangent.direction * weights[k]);
    }
    if (!placed.instance) return sum;
    const Affine& toWorld = placed.instance->toWorld;
    return TangentAt{toWorld.vector(sum.direction), toWorld.mirrors() ? -sum.side : sum.side};
}

std::optional<TangentAt> ofTriangle(const TriangleMesh& mesh, std::uint32_t number,
                                    const PlacedTriangle& placed, const TextureSlot& slot) {
    const auto [a, b, c] = placedCorners(mesh, number);
    const auto [p, q, r] = texturePlaces(mesh, placed.triangle, slot.layer);
    const Vec2f pq = q - p, pr = r - p;
    const auto area = static_cast<double>(pq.x * pr.y - pq.y * pr.x);
    if (!(std::abs(area) > 0)) return std::nullopt;
    const double sign = area > 0 ? 1 : -1;
    const Vec3d direction =
        ((b - a) * static_cast<double>(pr.y) - (c - a) * static_cast<double>(pq.y)) * sign;
    // t points down in the picture. The corners' order is that of the triangle's normal.
    const bool mirrored = placed.instance && placed.instance->toWorld.mirrors();
    return TangentAt{direction, mirrored ? sign : -sign};
}

}  // namespace

Vec3f mappedNormal(const TriangleMesh& mesh, std::uint32_t number, float u, float v,
                   const Vec3f& side, const Vec3f& shading) noexcept {
    const PlacedTriangle placed = placedTriangle(mesh, number);
    const Material* material = materialOf(mesh, placed.triangle);
    if (!material || material->normal.texture < 0) return shading;
    std::optional<TangentAt> tangent = interpolated(mesh, placed, u, v);
    if (!tangent) tangent = ofTriangle(mesh, number, placed, material->normal);
    if (!tangent) return shading;
    // The map is of the front, and the back shows the same hills as valleys.
    const double facing = placedNormal(mesh, number).dot(side) < 0 ? -1 : 1;
    const Vec3d n = Vec3d(shading) * facing;
    const Vec3d along = tangent->direction - n * n.dot(tangent->direction);
    const double length = along.length();
    if (!(length > 0 && std::isfinite(length))) return shading;
    const Vec3d s = along / length, t = n.cross(s) * tangent->side;
    const std::array<float, 4> stored = textureAt(mesh, placed.triangle, u, v, material->normal);
    const auto part = [&](std::size_t k) { return 2 * static_cast<double>(stored[k]) - 1; };
    const auto scale = static_cast<double>(material->normalScale);
    const Vec3d mapped = (s * (scale * part(0)) + t * (scale * part(1)) + n * part(2)) * facing;
    // What would face the inside of the surface is taken for an error of the map.
    return mapped.dot(Vec3d(side)) > 0 ? Vec3f(mapped.normalized()) : shading;
}

}  // namespace shadowcache
