#pragma once

// Private to the cache's .cpp files.

#include <functional>
#include <memory>

#include "common/cache/leaf_view.h"
#include "common/cache/shadow_cache.h"

namespace shadowcache {

struct CacheItems;

/// Gives the cache's .cpp files what is in an open one.
struct OpenCache {
    using VisitLeaf = std::function<void(const Vec3i& origin, const LeafView& leaf)>;
    /// Calls `visit` with each leaf of items, in the order of their numbers, and its first voxel.
    ///
    /// @param hits  wanted; without, the views need not have any
    /// @throws Error naming the file if it cannot be read any more
    static void visitLeaves(const ShadowCache& cache, bool hits, const VisitLeaf& visit);

    static std::unique_ptr<ShadowCache> make(const CacheHeader& header, const CacheItems& items);
};

}  // namespace shadowcache
