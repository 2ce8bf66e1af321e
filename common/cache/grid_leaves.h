#pragma once

// Private to the cache's .cpp files: names types of OpenVDB.

#include <filesystem>

#include "common/cache/cache_schema.h"
#include "common/cache/leaf_view.h"

namespace shadowcache {

/// The arrays of a leaf of items, and of the leaf of blocks at the same place (null: none), as long
/// as both stay. Sound, as requireSound() has it; firstItem is 0.
///
/// @throws Error naming the file if they are not what the format has
LeafView viewOf(PointLeaf& items, PointLeaf* blocks, const CacheHeader& header,
                const std::filesystem::path& path);

}  // namespace shadowcache
