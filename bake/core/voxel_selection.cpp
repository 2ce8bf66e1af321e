#include "bake/core/voxel_selection.h"

#include <algorithm>
#include <cassert>

#include "common/math/direction_mesh.h"

namespace shadowcache {

namespace {

/// Level of the cells that normals are rounded to: 2.6 degrees from their middle at most.
constexpr int kNormalLevel = 4;
constexpr std::uint32_t kSteps = 8;  ///< between two voxels' middles

}  // namespace

LookupPlaces::Place LookupPlaces::makePlace(std::uint64_t voxelKey, const Vec3f& position,
                                            const Vec3f& normal) {
    std::uint32_t code = locateCell(kNormalLevel, Vec3d(normal));
    for (int axis = 0; axis < 3; ++axis) {
        const auto step = static_cast<std::uint32_t>(position[axis] * kSteps);
        code = code * kSteps + std::min(step, kSteps - 1);
    }
    return {voxelKey, code};
}

Vec3f LookupPlaces::Place::position() const {
    const auto axis = [&](std::uint32_t below) {
        return (static_cast<float>(code / below % kSteps) + 0.5f) / kSteps;
    };
    return {axis(kSteps * kSteps), axis(kSteps), axis(1)};
}

Vec3f LookupPlaces::Place::normal() const {
    return Vec3f(cellCenter(kNormalLevel, normalCell(kNormalLevel)));
}

std::uint32_t LookupPlaces::Place::normalCell(int level) const {
    assert(level >= 0 && level <= kNormalLevel);
    return code / (kSteps * kSteps * kSteps) >> 2 * (kNormalLevel - level);
}

bool LookupPlaces::Place::isValid() const {
    return voxelKey < VoxelFrame::kKeys &&
           code < cellCount(kNormalLevel) * kSteps * kSteps * kSteps;
}

void LookupPlaces::add(std::vector<Place> places) {
    std::ranges::sort(places);
    const auto middle = static_cast<std::ptrdiff_t>(places_.size());
    places_.insert(places_.end(), places.begin(), places.end());
    std::inplace_merge(places_.begin(), places_.begin() + middle, places_.end());
    places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
}

VoxelSides::VoxelSides(const VoxelFrame& frame, const CacheItems& items) {
    for (std::size_t i = 0; i < items.size(); ++i)
        add(frame.key(items.voxel[i]), PatchCode::of(items.patch[i]).side);
}

bool VoxelSides::contains(std::uint64_t voxelKey, int side) const {
    const auto found = voxels_.find(voxelKey);
    return found != voxels_.end() && (found->second >> side & 1) != 0;
}

}  // namespace shadowcache
