#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/cache/shadow_cache.h"

namespace shadowcache {

/// Visibility of sixteen cells pooled over cache items.
struct alignas(64) PooledBlock {
    float visible[kBlockCells];  ///< sum over the items of weight * n / d
    float weight[kBlockCells];   ///< sum of the weights of the items that counted rays there, <= 1
    float rays[kBlockCells];     ///< sum of weight * d
    float rays2[kBlockCells];    ///< sum of weight^2 * d

    /// Visible share of cell i, in [0, 1]; weight[i] must be positive.
    float ratio(int i) const { return visible[i] / weight[i]; }
    /// Visible share of cell i, 0 where nothing was counted.
    float ratioOrNone(int i) const {
        const float share = visible[i] / (weight[i] > 1e-30f ? weight[i] : 1e-30f);
        return share < 1 ? share : 1.0f;
    }
    /// Rays that the ratio is worth: those of one item, or more where several share the weight.
    float effectiveRays(int i) const { return rays2[i] > 0 ? rays[i] * rays[i] / rays2[i] : 0.0f; }
};

/// The cache items around one place as one tree of visibility: base cells, and finer blocks where
/// any item has them. Reused from place to place; one object a thread, as children() pools on
/// demand.
class PooledVisibility {
public:
    /// @param tiers  of the cache: header().tiers()
    explicit PooledVisibility(const DirectionTiers& tiers);

    /// Pools the items of a lookup, whose weights sum to 1; forgets occluder cones. The items are
    /// read until the next call, because finer counts are pooled when they are asked for.
    void pool(std::span<const ItemView> items);

    /// Declares that something unknown to the counts may occlude what lies within `angle` [rad] of
    /// the unit vector `axis`: the visible regions there become uncertain. Adds to earlier cones.
    void addOccluderCone(const Vec3f& axis, float angle);

    /// How the counts refine in direction.
    const DirectionTiers& tiers() const { return tiers_; }
    /// Base cells 16 block .. 16 block + 15, block < baseBlocks(). Cells that do not exist have no
    /// weight.
    const PooledBlock& base(std::uint32_t block) const {
        return occluderCones_.empty() ? base_[block] : uncertainBase_[block];
    }
    /// Blocks of base cells: 2 or 5.
    std::uint32_t baseBlocks() const { return static_cast<std::uint32_t>(base_.size()); }
    /// Whether cell `parent` of tier 0 or 1 has children: an item refines it, or, at tier 0, an
    /// occluder cone meets it.
    bool hasChildren(int tier, std::uint32_t parent) const {
        return parents_[tiers_.blockKey(tier, parent)].link >= 0 ||
               (tier == 0 && isInOccluderCone(tiers_.baseLevel(), parent));
    }
    /// Children of that cell, or null if it has none; valid until the next call.
    const PooledBlock* children(int tier, std::uint32_t parent) const;

private:
    /// A cell that some item refines.
    struct Parent {
        std::int32_t link = -1;   ///< first of its blocks in links_; -1: none
        std::int32_t block = -1;  ///< in blocks_; -1: not pooled yet
    };
    /// A block of an item.
    struct Link {
        std::uint32_t item, block;
        std::int32_t next;  ///< block of the same cell in links_; -1: no more
    };

    /// A cone of directions that something may occlude.
    struct OccluderCone {
        Vec3f axis;
        float angle;
    };

    DirectionTiers tiers_;
    std::span<const ItemView> items_;
    std::vector<PooledBlock> base_;
    std::vector<PooledBlock> uncertainBase_;  ///< only with occluder cones
    std::vector<OccluderCone> occluderCones_;
    mutable std::vector<PooledBlock> blocks_;  ///< those that were asked for
    mutable std::vector<Parent> parents_;      ///< by key
    mutable std::vector<std::uint16_t> used_;  ///< keys with a link or a block
    std::vector<Link> links_;

    void addBase(const ItemView& item);
    void linkBlocks(std::size_t item);
    void poolBlock(std::uint16_t key, const PooledBlock* parents, int i, PooledBlock& block) const;
    bool isInOccluderCone(int level, std::uint32_t cell) const;
    void applyOccluderCones(int level, std::uint32_t firstCell, PooledBlock& block) const;
};

}  // namespace shadowcache
