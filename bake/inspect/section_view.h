#pragma once

#include "common/cache/volume_grids.h"
#include "common/image/image.h"

namespace shadowcache {

/// The voxels of a cache cut open across an axis and looked at along it, in false colour by
/// `values` (0 to 1); what lies deeper is paler.
///
/// @param axis   0: from +X, 1: from above, 2: from +Z
/// @param share  where the cut stands between the lowest voxel (0) and the highest (1)
/// @param side   most pixels that a side of the picture may have
Image sectionView(const std::vector<Vec3i>& voxels, const std::vector<Vec3f>& values, int axis,
                  double share, int side);

}  // namespace shadowcache
