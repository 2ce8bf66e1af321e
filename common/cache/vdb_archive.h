#pragma once

// Private to the cache's .cpp files, as is OpenVDB.

#include <openvdb/openvdb.h>

#include <filesystem>

namespace shadowcache {

/// Writes an OpenVDB file, beside the target first, then renamed. OpenVDB's own File::write does
/// not look whether its stream still works: on a full disk it leaves a broken file and says
/// nothing.
///
/// @throws Error when it cannot be written
void writeVdb(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids,
              const openvdb::MetaMap& metadata);

}  // namespace shadowcache
