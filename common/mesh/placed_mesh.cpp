#include "common/mesh/placed_mesh.h"

#include <algorithm>

namespace shadowcache {

std::size_t directCount(const TriangleMesh& mesh) {
    return mesh.instances.empty() ? mesh.triangles.size()
                                  : mesh.parts[mesh.firstSharedPart].firstTriangle;
}

std::size_t placedCount(const TriangleMesh& mesh) {
    if (mesh.instances.empty()) return mesh.triangles.size();
    const MeshInstance& last = mesh.instances.back();
    return std::size_t{last.firstPlaced} + last.triangleCount;
}

PlacedTriangle placedTriangle(const TriangleMesh& mesh, std::uint32_t number) noexcept {
    if (mesh.instances.empty() || number < mesh.instances.front().firstPlaced)
        return {number, nullptr};
    const auto next = std::upper_bound(
        mesh.instances.begin(), mesh.instances.end(), number,
        [](std::uint32_t n, const MeshInstance& instance) { return n < instance.firstPlaced; });
    const MeshInstance& instance = *(next - 1);
    return {mesh.parts[instance.firstPart].firstTriangle + number - instance.firstPlaced,
            &instance};
}

std::array<Vec3d, 3> placedCorners(const TriangleMesh& mesh, std::uint32_t number) noexcept {
    const PlacedTriangle placed = placedTriangle(mesh, number);
    const Vec3i& t = mesh.triangles[placed.triangle];
    std::array<Vec3d, 3> corners;
    for (int k = 0; k < 3; ++k) {
        const Vec3d p(mesh.positions[static_cast<std::size_t>(t[k])]);
        corners[static_cast<std::size_t>(k)] =
            placed.instance ? placed.instance->toWorld.point(p) : p;
    }
    return corners;
}

Vec3f placedNormal(const TriangleMesh& mesh, std::uint32_t number) noexcept {
    return placedNormal(mesh, number, placedCorners(mesh, number));
}

Vec3f placedNormal(const TriangleMesh& mesh, std::uint32_t number,
                   const std::array<Vec3d, 3>& corners) noexcept {
    const auto& [a, b, c] = corners;
    const MeshInstance* instance = placedTriangle(mesh, number).instance;
    const Vec3d n = (b - a).cross(c - a).normalized();
    return Vec3f(instance && instance->toWorld.mirrors() ? -n : n);
}

bool isDoubleSided(const TriangleMesh& mesh, std::uint32_t number) noexcept {
    const Material* material = materialOf(mesh, placedTriangle(mesh, number).triangle);
    return !material || material->doubleSided;
}

Box3d instanceBounds(const TriangleMesh& mesh, const MeshInstance& instance) {
    Box3d box;
    const std::uint32_t first = mesh.parts[instance.firstPart].firstTriangle;
    for (std::uint32_t i = first; i < first + instance.triangleCount; ++i)
        for (int k = 0; k < 3; ++k)
            box.extendBy(instance.toWorld.point(
                Vec3d(mesh.positions[static_cast<std::size_t>(mesh.triangles[i][k])])));
    return box;
}

Box3d placedBounds(const TriangleMesh& mesh) {
    Box3d box;
    for (std::size_t i = 0; i < directCount(mesh); ++i)
        for (int k = 0; k < 3; ++k)
            box.extendBy(Vec3d(mesh.positions[static_cast<std::size_t>(mesh.triangles[i][k])]));
    for (const MeshInstance& instance : mesh.instances)
        box.extendBy(instanceBounds(mesh, instance));
    return box;
}

const Material* materialOf(const TriangleMesh& mesh, std::uint32_t triangle) noexcept {
    if (mesh.parts.empty()) return nullptr;
    const auto next = std::upper_bound(
        mesh.parts.begin(), mesh.parts.end(), triangle,
        [](std::uint32_t t, const MeshPart& part) { return t < part.firstTriangle; });
    const int material = (next - 1)->material;
    return material < 0 ? nullptr : &mesh.materials[static_cast<std::size_t>(material)];
}

}  // namespace shadowcache
