#pragma once

#include "common/cache/volume_grids.h"
#include "common/image/image.h"

namespace shadowcache {

/// The voxels of a cache, cut across an axis and seen along it, in false colour; what lies deeper
/// is paler.
///
/// @param values  by voxel: x is what is shown, 0 to 1
/// @param axis    0: seen from +X, 1: from above, 2: from +Z
/// @param share   place of the cut between the lowest voxel (0) and the highest (1)
/// @param side    most pixels along a side of the picture, at least 1
Image sectionView(const std::vector<Vec3i>& voxels, const std::vector<Vec3f>& values, int axis,
                  double share, int side);

}  // namespace shadowcache
