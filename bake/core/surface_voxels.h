#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
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
        const Vec3i center = voxel(v);
        Vec3i step;
        for (step.z = -1; step.z <= 1; ++step.z)
            for (step.y = -1; step.y <= 1; ++step.y)
                for (step.x = -1; step.x <= 1; ++step.x) {
                    const std::size_t other = find(center + step);
                    if (other < size() && other != v) visit(other);
                }
    }

    /// Calls `isLast` with the number of each voxel that holds surface and is at most `margin`
    /// voxels from `v` along each axis, itself included, until it returns true. Walks over the
    /// voxels with surface, not over all of the box: with a margin of 64 it has two million.
    template <class IsLast>
    void searchAround(std::size_t v, int margin, const IsLast& isLast) const {
        const Vec3i center = voxel(v), low = frame_.clamped(center - Vec3i(margin)),
                    high = frame_.clamped(center + Vec3i(margin));
        for (int x = low.x & ~7; x <= high.x; x += 8)
            for (int y = low.y & ~7; y <= high.y; y += 8) {
                // Leaves of one x and y follow each other in the order of keys.
                const std::size_t end = firstFrom(frame_.key({x | 7, y | 7, high.z | 7}) + 1);
                for (std::size_t i = firstFrom(frame_.key({x, y, low.z & ~7})); i < end; ++i) {
                    const Vec3i way = voxel(i) - center;
                    const int distance =
                        std::max({std::abs(way.x), std::abs(way.y), std::abs(way.z)});
                    if (distance <= margin && isLast(i)) return;
                }
            }
    }

    /// Number of a voxel; size() if it holds no surface.
    std::size_t find(const Vec3i& voxel) const;

private:
    /// Number of the first voxel whose key is not below this one; size() if there is none.
    std::size_t firstFrom(std::uint64_t key) const;

    VoxelFrame frame_;
    std::vector<Fragment> fragments_;
    std::vector<std::span<const Fragment>> voxels_;
    std::vector<std::size_t> candidates_, wanted_;
};

}  // namespace shadowcache
