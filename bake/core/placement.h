#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bake/core/voxel_frame.h"
#include "bake/core/voxel_keys.h"
#include "common/mesh/mesh.h"

namespace shadowcache {

/// A part of a triangle in a voxel.
struct Fragment {
    std::uint64_t voxelKey;  ///< order of voxels in the file (VoxelFrame::key)
    std::uint32_t triangle;  ///< its number in the world (placed_mesh.h)
    float area;              ///< of the triangle's part in the voxel, > 0
};

/// Convex polygon of a triangle clipped to a voxel: three corners, and one more for each of six
/// planes.
struct Polygon {
    std::array<Vec3d, 9> corner;
    std::size_t count = 0;
};

/// Part of a triangle in a box. [Sutherland & Hodgman 1974]
Polygon clipToBox(const TriangleMesh& mesh, std::uint32_t triangle, const Box& box);

double area(const Polygon& polygon);

/// Appends the parts of a triangle of the world, in no stated order.
void cutTriangle(const TriangleMesh& mesh, const VoxelFrame& frame, std::uint32_t triangle,
                 std::vector<Fragment>& out);

/// Every (voxel, triangle) pair that meets, sorted by voxel, then triangle; without triangles that
/// repeat others (repeated_triangles.h).
///
/// @param only  voxels to place fragments in, which have the same bits as without; null: all
std::vector<Fragment> placeFragments(const TriangleMesh& mesh, const VoxelFrame& frame,
                                     const VoxelKeys* only = nullptr);

}  // namespace shadowcache
