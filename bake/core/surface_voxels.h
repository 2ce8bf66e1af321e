#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bake/core/options.h"
#include "bake/core/placement.h"

namespace shadowcache {

/// The voxels that a set's surface passes through, numbered in the order of their keys, and the
/// range of them that this shard bakes.
class SurfaceVoxels {
public:
    /// @throws Error as VoxelFrame does
    SurfaceVoxels(const TriangleMesh& mesh, double spacing, const BakeOptions& options);
    SurfaceVoxels(const SurfaceVoxels&) = delete;
    SurfaceVoxels& operator=(const SurfaceVoxels&) = delete;

    const VoxelFrame& frame() const { return frame_; }

    /// Of the whole set.
    std::size_t size() const { return voxels_.size(); }
    /// This shard's voxels are begin() .. end() - 1.
    std::size_t begin() const { return begin_; }
    std::size_t end() const { return end_; }

    Vec3i voxel(std::size_t v) const { return frame_.voxel(voxels_[v][0].voxelKey); }
    std::span<const Fragment> fragments(std::size_t v) const { return voxels_[v]; }

    /// This shard's voxels and those next to them, in order.
    std::vector<std::size_t> withNeighbours() const;

    /// Calls `visit` with the number of each of the 26 voxels around `v` that holds surface.
    template <class Visit>
    void visitNeighbours(std::size_t v, const Visit& visit) const {
        const Vec3i center = voxel(v);
        for (int k = 0; k < 27; ++k) {
            if (k == 13) continue;
            const std::size_t other = find(center + Vec3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
            if (other < size()) visit(other);
        }
    }

private:
    /// Number of a voxel; size() if it holds no surface.
    std::size_t find(const Vec3i& voxel) const;

    VoxelFrame frame_;
    std::vector<Fragment> fragments_;
    std::vector<std::span<const Fragment>> voxels_;
    std::size_t begin_ = 0, end_ = 0;
};

}  // namespace shadowcache
