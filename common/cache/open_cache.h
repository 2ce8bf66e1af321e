#pragma once

// Private to the cache's .cpp files: names types of OpenVDB.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "common/cache/cache_grids.h"
#include "common/cache/leaf_view.h"
#include "common/cache/paged_leaves.h"
#include "common/cache/shadow_cache.h"

namespace shadowcache {

/// What an open cache holds.
struct ShadowCache::Impl {
    CacheHeader header;
    std::size_t items = 0, blocks = 0;
    std::optional<PagedLeaves> paged;  ///< with a budget; else:
    CacheGrids grids;
    std::vector<LeafView> leaves;

    /// Takes all over that is in memory.
    ///
    /// @param path  for messages
    void take(CacheGrids all, const std::filesystem::path& path);

    using VisitLeaf = std::function<void(const openvdb::Coord& origin, const LeafView& leaf)>;
    /// Calls `visit` with each leaf of items, in the order of their numbers.
    ///
    /// @param hits  wanted; without, the views need not have any
    /// @throws Error naming the file if it cannot be read any more
    void visitLeaves(bool hits, const VisitLeaf& visit) const;
};

/// Gives the cache's .cpp files what is in an open one.
struct OpenCache {
    static const auto& of(const ShadowCache& cache) { return *cache.impl_; }
    static std::unique_ptr<ShadowCache> make(const CacheHeader& header, const CacheItems& items);
};

}  // namespace shadowcache
