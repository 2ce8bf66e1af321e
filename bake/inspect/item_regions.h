#pragma once

#include <vector>

#include "common/cache/shadow_cache.h"

namespace shadowcache {

/// One region of an item with its counts, d > 0.
struct CountedRegion {
    int level;
    std::uint32_t cell;
    unsigned n, d;
    double posterior;  ///< probability that a direction in it is open, by its counts and its
                       ///< ancestors', never quite 0 or 1 [docs/estimator.md]

    double share() const { return static_cast<double>(n) / d; }
};

/// The counts of an item, wherever they are kept, as a tree of regions.
class ItemRegions {
public:
    explicit ItemRegions(const DirectionTiers& tiers) : tiers_(tiers) {}

    /// An item of an open cache, as long as that is open.
    void use(const ItemView& item) { item_ = item; }
    /// Item i of `items`, as long as they stay.
    void use(const CacheItems& items, std::size_t i);

    /// The finest regions that rays were counted in; no two overlap. Valid until the next call.
    const std::vector<CountedRegion>& finest();

    /// The finest of them around a direction, given as its cell of level kMaxCacheLevel; d = 0 if
    /// no ray was counted there.
    CountedRegion along(std::uint32_t finestCell) const;

private:
    const std::uint8_t* block(int tier, std::uint32_t parent, const std::uint8_t*& d) const;
    void addCell(int tier, const CountedRegion& cell);
    double prior() const;
    int levelOf(int tier) const { return tiers_.baseLevel() + 2 * tier; }

    DirectionTiers tiers_;
    ItemView item_{};
    std::vector<CountedRegion> finest_;
    std::vector<std::int16_t> keys_;  ///< of an item of CacheItems, whose blocks hold them apart
    std::vector<std::uint8_t> blockN_, blockD_;
};

}  // namespace shadowcache
