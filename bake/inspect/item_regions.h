#pragma once

#include <optional>
#include <vector>

#include "common/cache/cache_items.h"
#include "common/predict/count_tree.h"

namespace shadowcache {

/// One region of an item with its counts.
struct CountedRegion {
    int level;           ///< of the direction mesh
    std::uint32_t cell;  ///< of that level
    unsigned n, d;       ///< rays that reached the sky, and all rays
    double posterior;    ///< probability that a direction in it is visible, by its counts and its
                         ///< ancestors', in (0, 1) [docs/estimator.md]

    /// Visible share, in [0, 1]; d must be positive.
    double share() const { return static_cast<double>(n) / d; }
};

/// The counts of an item, wherever they are kept, as regions of directions. Reused from item to
/// item; use() comes first.
class ItemRegions {
public:
    explicit ItemRegions(const DirectionTiers& tiers) : tiers_(tiers) {}

    /// An item of an open cache, as long as that is open.
    void use(const ItemView& item) { counts_.emplace(item, tiers_); }
    /// Item i of `items`, which outlive the regions.
    void use(const CacheItems& items, std::size_t i);

    /// The finest regions that rays were counted in, d > 0; no two overlap. Valid until the next
    /// call.
    const std::vector<CountedRegion>& finest();

    /// The finest of them around a direction, given as its cell of level kMaxCacheLevel; d = 0 if
    /// no ray was counted there.
    CountedRegion along(std::uint32_t finestCell) const;

private:
    double prior() const;
    CountedRegion region(int tier, std::uint32_t cell, const BlockCounts& counts,
                         double prior) const;

    DirectionTiers tiers_;
    std::optional<ItemCountTree> counts_;
    std::vector<CountedRegion> finest_;
    std::vector<std::int16_t> keys_;  ///< of an item of CacheItems, whose blocks hold them apart
};

}  // namespace shadowcache
