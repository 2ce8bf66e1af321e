#pragma once

#include <filesystem>
#include <span>

#include "common/cache/cache_items.h"

namespace shadowcache {

/// Sum of the caches, which must be of one set, spacing, direction level and kind of refinement.
///
/// @throws Error naming the file that differs, what it holds and what the first one holds
CacheItems mergeCaches(std::span<const std::filesystem::path> paths, CacheHeader& header);

}  // namespace shadowcache
