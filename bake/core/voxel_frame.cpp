#include "bake/core/voxel_frame.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "bake/core/least_spacing.h"
#include "common/base/error.h"
#include "common/mesh/placed_mesh.h"

namespace shadowcache {

namespace {

constexpr int kLeafBits = 17;  // 8^3 leaves along an axis
constexpr int kMaxVoxels = 1 << (kLeafBits + 3);
static_assert(VoxelFrame::kKeys == std::uint64_t{1} << (3 * kLeafBits + 9));

Vec3i floorVector(const Vec3d& v) {
    return {static_cast<int>(std::floor(v.x)), static_cast<int>(std::floor(v.y)),
            static_cast<int>(std::floor(v.z))};
}

}  // namespace

double leastSpacing(const TriangleMesh& mesh) {
    const Imath::Box3d box = placedBounds(mesh);
    const Vec3d low = box.min + mesh.origin, high = box.max + mesh.origin, size = high - low;
    const double most = std::max({size.x, size.y, size.z});
    const double farthest = std::max({std::abs(low.x), std::abs(low.y), std::abs(low.z),
                                      std::abs(high.x), std::abs(high.y), std::abs(high.z)});
    return std::max(most / (kMaxVoxels - 16), farthest / 2e9);
}

VoxelFrame::VoxelFrame(const TriangleMesh& mesh, double spacing)
    : spacing_(spacing), origin_(mesh.origin) {
    if (const double least = leastSpacing(mesh); spacing < least)
        throw Error(fmt::format("--spacing {:g}: too small for this set, expected at least {:g}",
                                spacing, least));
    const Vec3i v = floorVector((placedBounds(mesh).min + origin_) / spacing);
    base_ = {(v.x & ~7) - 8, (v.y & ~7) - 8, (v.z & ~7) - 8};
}

std::uint64_t VoxelFrame::key(const Vec3i& voxel) const {
    const Vec3i v = voxel - base_;
    const auto bits = [](int value) { return static_cast<std::uint64_t>(value); };
    const std::uint64_t leaf =
        (((bits(v.x) >> 3) << kLeafBits | bits(v.y) >> 3) << kLeafBits) | bits(v.z) >> 3;
    return leaf << 9 | (bits(v.x) & 7) << 6 | (bits(v.y) & 7) << 3 | (bits(v.z) & 7);
}

bool VoxelFrame::holds(const Vec3i& voxel) const {
    for (int axis = 0; axis < 3; ++axis) {
        const auto at = std::int64_t{voxel[axis]} - base_[axis];
        if (at < 0 || at >= kMaxVoxels) return false;
    }
    return true;
}

Vec3i VoxelFrame::clamped(const Vec3i& voxel) const {
    Vec3i held;
    for (int axis = 0; axis < 3; ++axis)
        held[axis] = std::clamp(voxel[axis], base_[axis], base_[axis] + kMaxVoxels - 1);
    return held;
}

Vec3i VoxelFrame::voxel(std::uint64_t key) const {
    const std::uint64_t leaf = key >> 9, mask = (1u << kLeafBits) - 1;
    const auto axis = [&](int shift, int low) {
        return static_cast<int>(((leaf >> shift) & mask) << 3 | ((key >> low) & 7));
    };
    return base_ + Vec3i(axis(2 * kLeafBits, 6), axis(kLeafBits, 3), axis(0, 0));
}

Vec3i VoxelFrame::voxelAt(const Vec3d& position) const {
    return floorVector((position + origin_) / spacing_ + Vec3d(0.5));
}

Vec3d VoxelFrame::center(const Vec3i& voxel) const {
    return Vec3d(voxel) * spacing_ - origin_;
}

Box VoxelFrame::box(const Vec3i& voxel) const {
    return {center(voxel), Vec3d(spacing_ / 2)};
}

}  // namespace shadowcache
