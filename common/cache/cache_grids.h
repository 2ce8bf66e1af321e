#pragma once

// Private to the cache's .cpp files: names types of OpenVDB.

#include <filesystem>

#include "common/cache/cache_schema.h"

namespace shadowcache {

/// The two point grids of a cache file, wholly in memory.
struct CacheGrids {
    CacheHeader header;
    PointGrid::Ptr items;
    PointGrid::Ptr blocks;
};

/// @throws Error naming the file and the cause: missing, truncated, foreign, of another format
/// version
CacheGrids readGrids(const std::filesystem::path& path);

}  // namespace shadowcache
