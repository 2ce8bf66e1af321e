#pragma once

// Private to the cache's .cpp files, as is OpenVDB.

#include <filesystem>

#include "common/cache/openvdb_grids.h"

namespace shadowcache {

/// Registers OpenVDB's types. Idempotent and thread-safe.
void initializeOpenVdb();

/// Index to world space for voxels of side `spacing` > 0 [world units].
openvdb::math::Transform::Ptr makeTransform(double spacing);

/// Writes an OpenVDB file with checksums to a temporary file that is then renamed. OpenVDB's own
/// File::write does not check its stream: on a full disk it leaves a broken file without an error.
///
/// @throws Error when it cannot be written
void writeVdb(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids,
              const openvdb::MetaMap& metadata);

}  // namespace shadowcache
