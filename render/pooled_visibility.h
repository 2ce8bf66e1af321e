#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/shadow_cache.h"

namespace shadowcache {

/// Visibility of sixteen cells pooled over cache items.
struct alignas(64) PooledBlock {
    float open[kBlockCells];    ///< sum over the items of weight * n / d
    float weight[kBlockCells];  ///< sum of the weights of the items that counted rays there, <= 1
    float rays[kBlockCells];    ///< sum of weight * d
    float rays2[kBlockCells];   ///< sum of weight^2 * d

    /// Visible share of cell i, in [0, 1]; weight[i] must be positive.
    float ratio(int i) const { return open[i] / weight[i]; }
    /// Rays that the ratio is worth: those of one item, or more where several share the weight.
    float effectiveRays(int i) const { return rays2[i] > 0 ? rays[i] * rays[i] / rays2[i] : 0.0f; }
};

/// The cache items around one place as one tree of visibility: base cells, and finer blocks where
/// any item has them. Reused from place to place.
class PooledVisibility {
public:
    explicit PooledVisibility(const DirectionTiers& tiers);

    /// Pools `items`, whose weights sum to 1.
    void pool(std::span<const ItemView> items);

    /// Something that the counts know nothing of may hide what lies within `angle` [rad] of the
    /// unit vector `axis`: the regions there that were open become uncertain.
    void doubt(const Vec3f& axis, float angle);

    const DirectionTiers& tiers() const { return tiers_; }
    /// Base cells 16 block .. 16 block + 15.
    const PooledBlock& base(std::uint32_t block) const { return base_[block]; }
    std::uint32_t baseBlocks() const { return static_cast<std::uint32_t>(base_.size()); }
    /// Children of cell `parent` of tier 0 or 1, or null where no item has them.
    const PooledBlock* children(int tier, std::uint32_t parent) const {
        const std::int16_t slot = slots_[tiers_.blockKey(tier, parent)];
        return slot < 0 ? nullptr : &blocks_[static_cast<std::size_t>(slot)];
    }

    /// Marks of the cells 16 block .. 16 block + 15 of tier 0 or 1: negative where children() is
    /// null.
    const std::int16_t* childSlots(int tier, std::uint32_t block) const {
        return slots_.data() + tiers_.blockKey(tier, block * kBlockCells);
    }

private:
    DirectionTiers tiers_;
    std::vector<PooledBlock> base_;
    std::vector<PooledBlock> blocks_;
    std::vector<float> counted_;       ///< per block: weight of the items that have it
    std::vector<float> countedOpen_;   ///< per block: their open weight in the parent cell
    std::vector<std::int16_t> slots_;  ///< by key; -1: none
    std::vector<std::uint16_t> used_;  ///< keys with a slot

    void addBase(const ItemView& item);
    void addBlocks(const ItemView& item);
    void completeBlocks();
    PooledBlock& childrenForDoubt(std::uint32_t parent);
};

}  // namespace shadowcache
