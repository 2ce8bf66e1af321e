#include "bake/core/voxel_keys.h"

#include "bake/core/voxel_frame.h"

namespace shadowcache {

namespace {

/// Voxels, or else leaves, of a box that are looked at one by one.
constexpr double kMostSteps = 64;

/// Calls `isThere` for the voxels of a box, `step` apart, until one is.
template <class IsThere>
bool anyOf(const Vec3i& first, const Vec3i& last, int step, const IsThere& isThere) {
    for (int x = first.x; x <= last.x; x += step)
        for (int y = first.y; y <= last.y; y += step)
            for (int z = first.z; z <= last.z; z += step)
                if (isThere(Vec3i(x, y, z))) return true;
    return false;
}

double count(const Vec3i& first, const Vec3i& last, int step) {
    const Vec3d size = Vec3d(last - first) / step + Vec3d(1);
    return size.x * size.y * size.z;
}

}  // namespace

bool VoxelKeys::mayTouch(const VoxelFrame& frame, const Vec3i& first, const Vec3i& last) const {
    if (count(first, last, 1) <= kMostSteps)
        return anyOf(first, last, 1, [&](const Vec3i& v) { return contains(frame.key(v)); });
    const Vec3i firstLeaf(first.x & ~7, first.y & ~7, first.z & ~7);
    if (count(firstLeaf, last, 8) > kMostSteps) return true;
    return anyOf(firstLeaf, last, 8,
                 [&](const Vec3i& v) { return leaves_.contains(frame.key(v) >> 9); });
}

}  // namespace shadowcache
