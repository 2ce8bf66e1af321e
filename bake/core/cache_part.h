#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/cache/cache_items.h"

namespace shadowcache {

/// Sides of voxels that items are of.
std::uint64_t countSides(const CacheItems& items);

/// Shots of both parts of a set. Its sides are yet to be counted.
CachePart joinParts(const CachePart& a, const CachePart& b);

/// The part with its sides counted in `items`; none if it is everything.
std::optional<CachePart> countPart(CachePart part, const CacheItems& items);

}  // namespace shadowcache
