#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/cache/item_table.h"
#include "common/cache/shadow_cache.h"

namespace shadowcache {

/// Stands for the sky where a ray would have met an item, and for backs that reflect nothing.
inline constexpr std::uint32_t kSky = 0xffffffff;

/// Which items the rays of each item met: light's ways through the set, whatever the light. The
/// rays of an item leave its surface, distributed as the cosine to its mean normal and stratified.
/// [docs/format.md, Hits]
struct Transport {
    int raysPerItem = 0;
    /// Items times raysPerItem, by number (ItemView::number): the item that a ray met; kSky; or
    /// kNoItem where it met a surface without an item in the cache, or did not get away from
    /// its own (HitCode::isFree).
    std::vector<std::uint32_t> hit;

    std::size_t memoryBytes() const { return hit.capacity() * sizeof hit[0]; }
};

/// The hits that a cache keeps, each as one of its items; none if it keeps none.
///
/// @param items  of the same cache
/// @throws Error naming the cache's file if that cannot be read any more
std::optional<Transport> readTransport(const ShadowCache& cache, const ItemTable& items);

/// EmitterCode of each emitter that a cache counts (CacheHeader::emitters) by item, item by item;
/// empty if it counts none.
///
/// @throws Error naming the cache's file if that cannot be read any more
std::vector<std::uint16_t> readEmitterCodes(const ShadowCache& cache);

}  // namespace shadowcache
