#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bake/core/voxel_keys.h"
#include "common/mesh/mesh.h"

namespace shadowcache {

/// A part of a triangle in a voxel.
struct Fragment {
    std::uint64_t voxelKey;  ///< order of voxels in the file (VoxelFrame::key)
    std::uint32_t triangle;  ///< its number in the world (placed_mesh.h)
    float area;              ///< of the triangle's part in the voxel, > 0
};

/// A box around a point.
struct Box {
    Vec3d center;
    Vec3d half;  ///< of its sizes
};

/// The grid of voxels over a mesh: voxel v is centred at v * spacing in world space.
class VoxelFrame {
public:
    /// @throws Error if the mesh spans more than 2^20 voxels along an axis, naming the least
    /// spacing
    VoxelFrame(const TriangleMesh& mesh, double spacing);

    double spacing() const { return spacing_; }
    /// Order of a voxel that the frame holds.
    std::uint64_t key(const Vec3i& voxel) const;
    /// Whether a voxel is one of the frame's, as all that hold surface and their neighbours are.
    bool holds(const Vec3i& voxel) const;
    Vec3i voxel(std::uint64_t key) const;
    /// Voxel that holds a point given relative to the mesh's origin.
    Vec3i voxelAt(const Vec3d& position) const;
    /// Middle of a voxel relative to the mesh's origin.
    Vec3d center(const Vec3i& voxel) const;
    /// That voxel.
    Box box(const Vec3i& voxel) const;

private:
    double spacing_;
    Vec3d origin_;
    Vec3i base_;  ///< a multiple of 8 below every voxel
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

/// Every (voxel, triangle) pair that meets, sorted by voxel, then triangle.
///
/// @param only  voxels to place fragments in, which have the same bits as without; null: all
std::vector<Fragment> placeFragments(const TriangleMesh& mesh, const VoxelFrame& frame,
                                     const VoxelKeys* only = nullptr);

}  // namespace shadowcache
