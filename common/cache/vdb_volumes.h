#pragma once

// Private to the cache's .cpp files: names types of OpenVDB.

#include "common/cache/openvdb_grids.h"
#include "common/cache/volume_grids.h"

namespace shadowcache {

/// The grid in OpenVDB's terms, saved as half; its values belong to `voxels`, in their order.
openvdb::GridBase::Ptr makeVdbGrid(const CacheHeader& header, const std::vector<Vec3i>& voxels,
                                   const VolumeGrid& grid);

}  // namespace shadowcache
