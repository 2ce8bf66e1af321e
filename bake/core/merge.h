#pragma once

#include <filesystem>
#include <span>

#include "common/cache/cache_items.h"

namespace shadowcache {

/// Sum of the caches, which must be of one set, spacing, direction level and kind of refinement,
/// and hold other shards, shots or seeds. Reads one cache after the other: memory holds the sum,
/// at most as much again while two sums are added, and one input. Counts are added by mergeItems
/// (cache_items.h).
///
/// @throws Error naming the file that differs, its value and that of another file
CacheItems mergeCaches(std::span<const std::filesystem::path> paths, CacheHeader& header);

}  // namespace shadowcache
