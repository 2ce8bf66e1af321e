#pragma once

#include <filesystem>

#include "bake/core/bake_identity.h"
#include "bake/core/surface_count.h"
#include "bake/core/voxel_selection.h"

namespace shadowcache {

/// What the bakes of all shards of a shot have in common, so that it is found once.
struct ShotLookups {
    double spacing = 0;   ///< of the voxels, chosen or given
    int level = 0;        ///< finest direction level, where a bake is given none
    SurfaceCount ofSet;   ///< the set's surface in such voxels
    LookupPlaces places;  ///< in them
};

/// Writes a file that appears when it is complete.
///
/// @param identity  of all that the lookups depend on
/// @throws Error if the file cannot be written
void writeLookups(const std::filesystem::path& path, const BakeIdentity& identity,
                  const ShotLookups& lookups);

/// @throws Error naming the file if it is not such a file, is damaged, or is of another shot; then
/// the message says what differs
ShotLookups readLookups(const std::filesystem::path& path, const BakeIdentity& identity);

}  // namespace shadowcache
