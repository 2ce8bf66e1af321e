#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/cache/cache_items.h"

namespace shadowcache {

/// The sides of voxels that have items.
std::uint64_t countSides(const CacheItems& items);

/// The part with the shots of both parts. Its sides are not counted yet.
CachePart joinParts(const CachePart& a, const CachePart& b);

/// The part with the number of sides that `items` has; none if it is the whole set.
std::optional<CachePart> countPart(CachePart part, const CacheItems& items);

}  // namespace shadowcache
