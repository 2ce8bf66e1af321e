#include "bake/core/surface_voxels.h"

#include <algorithm>

namespace shadowcache {

SurfaceVoxels::SurfaceVoxels(const TriangleMesh& mesh, double spacing, const BakeOptions& options)
    : frame_(mesh, spacing), fragments_(placeFragments(mesh, frame_)) {
    const std::span<const Fragment> all = fragments_;
    for (std::size_t first = 0; first < all.size();) {
        std::size_t last = first;
        while (last < all.size() && all[last].voxelKey == all[first].voxelKey) ++last;
        voxels_.push_back(all.subspan(first, last - first));
        first = last;
    }
    const auto boundary = [&](int shard) {
        return size() * static_cast<std::size_t>(shard) / static_cast<std::size_t>(options.shards);
    };
    begin_ = boundary(options.shard);
    end_ = boundary(options.shard + 1);
}

std::size_t SurfaceVoxels::find(const Vec3i& voxel) const {
    const std::uint64_t key = frame_.key(voxel);
    const auto found = std::lower_bound(
        voxels_.begin(), voxels_.end(), key,
        [](const auto& fragments, std::uint64_t wanted) { return fragments[0].voxelKey < wanted; });
    if (found == voxels_.end() || (*found)[0].voxelKey != key) return size();
    return static_cast<std::size_t>(found - voxels_.begin());
}

std::vector<std::size_t> SurfaceVoxels::withNeighbours() const {
    std::vector<std::uint8_t> needed(size(), 0);
    std::fill(needed.begin() + static_cast<std::ptrdiff_t>(begin_),
              needed.begin() + static_cast<std::ptrdiff_t>(end_), std::uint8_t{1});
    if (end_ - begin_ < size())
        for (std::size_t v = begin_; v < end_; ++v)
            visitNeighbours(v, [&](std::size_t other) { needed[other] = 1; });
    std::vector<std::size_t> list;
    for (std::size_t v = 0; v < size(); ++v)
        if (needed[v]) list.push_back(v);
    return list;
}

}  // namespace shadowcache
