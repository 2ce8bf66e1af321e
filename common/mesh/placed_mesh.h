#pragma once

#include <array>

#include "common/mesh/mesh.h"

namespace shadowcache {

// A set as the world sees it: the triangles that stand in it directly are numbered as in the mesh,
// the copies that instances make follow, instance after instance.

/// Triangles that stand in the world directly; those behind them are shared by instances.
std::size_t directCount(const TriangleMesh& mesh);

/// Triangles in the world.
std::size_t placedCount(const TriangleMesh& mesh);

/// A triangle of the world.
struct PlacedTriangle {
    std::uint32_t triangle = 0;              ///< of TriangleMesh::triangles
    const MeshInstance* instance = nullptr;  ///< that puts it into the world, or null
};
PlacedTriangle placedTriangle(const TriangleMesh& mesh, std::uint32_t number) noexcept;

/// Its corners, relative to the mesh's origin.
std::array<Vec3d, 3> placedCorners(const TriangleMesh& mesh, std::uint32_t number) noexcept;

/// Its unit geometric normal, by its winding in the file.
Vec3f placedNormal(const TriangleMesh& mesh, std::uint32_t number) noexcept;
/// The same where its corners are known.
Vec3f placedNormal(const TriangleMesh& mesh, std::uint32_t number,
                   const std::array<Vec3d, 3>& corners) noexcept;

/// Whether both of its sides are seen.
bool isDoubleSided(const TriangleMesh& mesh, std::uint32_t number) noexcept;

/// Box of the world's triangles, relative to the mesh's origin.
Box3d placedBounds(const TriangleMesh& mesh);

/// Box of the triangles that an instance puts into the world, likewise.
Box3d instanceBounds(const TriangleMesh& mesh, const MeshInstance& instance);

/// Material of TriangleMesh::triangles[triangle], or null where it has none.
const Material* materialOf(const TriangleMesh& mesh, std::uint32_t triangle) noexcept;

}  // namespace shadowcache
