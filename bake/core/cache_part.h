#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/cache/cache_items.h"

namespace shadowcache {

/// Sides of voxels that items are of.
std::uint64_t countSides(const CacheItems& items);

/// What `items`, of several parts of a set, hold of it; none if it is everything.
std::optional<CachePart> joinParts(const CachePart& a, const CachePart& b, const CacheItems& items);

}  // namespace shadowcache
