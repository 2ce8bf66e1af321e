#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bake/core/options.h"
#include "bake/core/placement.h"
#include "bake/core/voxel_selection.h"

namespace shadowcache {

/// Voxels that a set's surface passes through, numbered in the order of their keys: those that may
/// hold items of a selection, and those next to them. Of the first, a shard bakes its part.
class SurfaceVoxels {
public:
    /// @throws Error as VoxelFrame does
    SurfaceVoxels(const TriangleMesh& mesh, double spacing, const BakeOptions& options,
                  const VoxelSelection& selection);
    SurfaceVoxels(const SurfaceVoxels&) = delete;
    SurfaceVoxels& operator=(const SurfaceVoxels&) = delete;

    const VoxelFrame& frame() const { return frame_; }

    std::size_t size() const { return voxels_.size(); }
    /// Numbers of the voxels that may hold items of the selection, in order.
    const std::vector<std::size_t>& candidates() const { return candidates_; }
    /// Those of them that this shard bakes.
    const std::vector<std::size_t>& wanted() const { return wanted_; }

    std::uint64_t key(std::size_t v) const { return voxels_[v][0].voxelKey; }
    Vec3i voxel(std::size_t v) const { return frame_.voxel(key(v)); }
    std::span<const Fragment> fragments(std::size_t v) const { return voxels_[v]; }

    /// The wanted voxels and those next to them, in order.
    std::vector<std::size_t> withNeighbours() const;
    /// The same of other voxels.
    std::vector<std::size_t> withNeighbours(const std::vector<std::size_t>& voxels) const;

    /// Calls `visit` with the number of each of the 26 voxels around `v` that holds surface.
    template <class Visit>
    void visitNeighbours(std::size_t v, const Visit& visit) const {
        visitAround(v, 1, [&](std::size_t other) {
            if (other != v) visit(other);
        });
    }

    /// Calls `visit` with the number of each voxel that holds surface and is at most `margin`
    /// voxels from `v` along each axis, itself included.
    template <class Visit>
    void visitAround(std::size_t v, int margin, const Visit& visit) const {
        const Vec3i center = voxel(v);
        Vec3i step;
        for (step.z = -margin; step.z <= margin; ++step.z)
            for (step.y = -margin; step.y <= margin; ++step.y)
                for (step.x = -margin; step.x <= margin; ++step.x)
                    if (const std::size_t other = find(center + step); other < size()) visit(other);
    }

    /// Number of a voxel; size() if it holds no surface.
    std::size_t find(const Vec3i& voxel) const;

private:
    VoxelFrame frame_;
    std::vector<Fragment> fragments_;
    std::vector<std::span<const Fragment>> voxels_;
    std::vector<std::size_t> candidates_, wanted_;
};

}  // namespace shadowcache
