#include "bake/core/surface_voxels.h"

#include <algorithm>
#include <utility>

#include "common/base/interrupt.h"

namespace shadowcache {

namespace {

/// The voxels that lookups go to, and `margin` voxels around them: a box around each, which grows
/// along one axis after the other.
VoxelKeys keysAround(const LookupPlaces& lookups, const VoxelFrame& frame, int margin) {
    VoxelKeys keys;
    for (const LookupPlaces::Place& place : lookups.places()) keys.add(place.voxelKey);
    for (int axis = 0; axis < 3; ++axis) {
        VoxelKeys grown;
        keys.forEach([&](std::uint64_t key) {
            throwIfInterrupted();
            const Vec3i low = frame.voxel(key);
            Vec3i step(0);
            for (step[axis] = -margin; step[axis] <= margin + 1; ++step[axis])
                if (frame.holds(low + step)) grown.add(frame.key(low + step));
        });
        keys = std::move(grown);
    }
    return keys;
}

std::vector<Fragment> placeSelected(const TriangleMesh& mesh, const VoxelFrame& frame,
                                    const VoxelSelection& selection) {
    if (!selection.lookups) return placeFragments(mesh, frame);
    const VoxelKeys only = keysAround(*selection.lookups, frame, selection.margin + 1);
    return placeFragments(mesh, frame, &only);
}

}  // namespace

SurfaceVoxels::SurfaceVoxels(const TriangleMesh& mesh, double spacing, const BakeOptions& options,
                             const VoxelSelection& selection)
    : frame_(mesh, spacing), fragments_(placeSelected(mesh, frame_, selection)) {
    VoxelKeys selected;
    if (selection.lookups) selected = keysAround(*selection.lookups, frame_, selection.margin);
    const std::span<const Fragment> all = fragments_;
    for (std::size_t first = 0; first < all.size();) {
        std::size_t last = first;
        while (last < all.size() && all[last].voxelKey == all[first].voxelKey) ++last;
        if (!selection.lookups || selected.contains(all[first].voxelKey))
            candidates_.push_back(voxels_.size());
        voxels_.push_back(all.subspan(first, last - first));
        first = last;
    }
    const auto boundary = [&](int shard) {
        return candidates_.begin() +
               static_cast<std::ptrdiff_t>(candidates_.size() * static_cast<std::size_t>(shard) /
                                           static_cast<std::size_t>(options.shards));
    };
    wanted_.assign(boundary(options.shard), boundary(options.shard + 1));
}

std::size_t SurfaceVoxels::find(const Vec3i& voxel) const {
    const std::uint64_t wanted = frame_.key(voxel);
    const std::size_t found = firstFrom(wanted);
    return found < size() && key(found) == wanted ? found : size();
}

std::size_t SurfaceVoxels::firstFrom(std::uint64_t key) const {
    const auto found = std::lower_bound(
        voxels_.begin(), voxels_.end(), key,
        [](const auto& fragments, std::uint64_t wanted) { return fragments[0].voxelKey < wanted; });
    return static_cast<std::size_t>(found - voxels_.begin());
}

std::vector<std::size_t> SurfaceVoxels::withNeighbours() const {
    return wanted_.size() == size() ? wanted_ : withNeighbours(wanted_);
}

std::vector<std::size_t> SurfaceVoxels::withNeighbours(
    const std::vector<std::size_t>& voxels) const {
    std::vector<std::uint8_t> needed(size(), 0);
    for (const std::size_t v : voxels) {
        needed[v] = 1;
        visitNeighbours(v, [&](std::size_t other) { needed[other] = 1; });
    }
    std::vector<std::size_t> list;
    for (std::size_t v = 0; v < size(); ++v)
        if (needed[v]) list.push_back(v);
    return list;
}

}  // namespace shadowcache
