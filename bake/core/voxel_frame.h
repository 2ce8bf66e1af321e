#pragma once

#include <cstdint>

#include "common/mesh/mesh.h"

namespace shadowcache {

/// A box around a point.
struct Box {
    Vec3d center;
    Vec3d half;  ///< half of its size along each axis
};

/// The grid of voxels over a mesh: voxel v is centred at v * spacing in world space.
class VoxelFrame {
public:
    /// @throws Error if the mesh spans more than 2^20 voxels along an axis, naming the least
    /// spacing
    VoxelFrame(const TriangleMesh& mesh, double spacing);

    /// Keys are less than this.
    static constexpr std::uint64_t kKeys = std::uint64_t{1} << 60;

    double spacing() const { return spacing_; }
    /// Order of a voxel that the frame holds.
    std::uint64_t key(const Vec3i& voxel) const;
    /// Whether a voxel is one of the frame's, as all that hold surface and their neighbours are.
    bool holds(const Vec3i& voxel) const;
    /// The voxel of the frame that is nearest.
    Vec3i clamped(const Vec3i& voxel) const;
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

}  // namespace shadowcache
