#pragma once

// Private to the cache's .cpp files: names types of OpenVDB.

#include <filesystem>

#include "common/cache/cache_items.h"
#include "common/cache/cache_schema.h"
#include "common/cache/checksums.h"

namespace shadowcache {

/// The two point grids of a cache file, wholly in memory.
struct CacheGrids {
    CacheHeader header;
    PointGrid::Ptr items;
    PointGrid::Ptr blocks;
};

/// Opens a file that has the checksums of a cache.
///
/// @throws Error naming the file and the cause: missing, truncated, foreign, of another format
/// version
CheckedFile openChecked(const std::filesystem::path& path);

/// What a cache records of its bake. @throws Error as openChecked()
CacheHeader readHeader(const CheckedFile& file);

/// The grids that a file of these items holds.
CacheGrids makeGrids(const CacheHeader& header, const CacheItems& items);

/// Checks every byte of the file before OpenVDB decodes it.
///
/// @throws Error naming the file and the cause: missing, truncated, foreign, of another format
/// version
CacheGrids readGrids(const std::filesystem::path& path);

}  // namespace shadowcache
