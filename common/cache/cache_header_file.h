#pragma once

// Private to the cache's .cpp files: names types of OpenVDB.

#include <filesystem>

#include "common/cache/cache_header.h"
#include "common/cache/openvdb_grids.h"

namespace shadowcache {

/// What a file's metadata say of a cache of so many items (docs/format.md).
openvdb::MetaMap toMetadata(const CacheHeader& header, std::size_t items);

/// @throws Error naming the file if it is no cache, of another format or without something
CacheHeader fromMetadata(const openvdb::MetaMap& meta, const std::filesystem::path& path);

}  // namespace shadowcache
