#pragma once

#include <cstdint>
#include <vector>

#include "common/environment.h"
#include "render/pooled_visibility.h"

namespace shadowcache {

/// Sixteen consecutive cells of one level, as a group of regions to draw samples from. Cells that
/// are no regions (below the horizon, dark, or split further) have no spread.
struct RegionGroup {
    std::uint32_t firstCell;
    int level;
    float spreadSum;
    float spreadMax;
};

/// The regions of one shading point: what the cache predicts of each, and how unsure it is.
/// [docs/estimator.md] Arrays are reused from point to point.
class RegionWeights {
public:
    RegionWeights(const Environment& environment, const DirectionTiers& tiers);

    /// Splits the hemisphere around `normal` into regions by the pooled counts: the control
    /// variate's integral goes to predicted(), the groups to groups().
    void weigh(const PooledVisibility& pooled, const Vec3f& normal);

    /// Sum over the regions of c_r (n . V_r): the irradiance the cache predicts.
    const double* predicted() const { return predicted_; }
    /// Sum of all spreads: the standard deviation of one sample drawn in proportion to them, as far
    /// as the counts tell.
    double spreadSum() const { return spreadSum_; }

    std::size_t size() const { return groups_.size(); }
    const RegionGroup& group(std::size_t g) const { return groups_[g]; }
    /// Predicted standard deviation of the residual in each region of the group.
    float* spread(std::size_t g) { return lanes_[g].spread; }
    /// c_r: the visibility that the control variate assumes.
    const float* visibility(std::size_t g) const { return lanes_[g].visibility; }

private:
    struct alignas(64) Lanes {
        float spread[kBlockCells];
        float visibility[kBlockCells];
    };
    /// What a cell hands down to its children.
    struct Parent {
        float visibility;
        float posterior;
    };
    void weighBlock(int tier, std::uint32_t block, const PooledBlock* counts, const Parent& parent);

    const Environment& environment_;
    DirectionTiers tiers_;
    int finest_;  ///< level down to which cells on the horizon are split
    const PooledVisibility* pooled_ = nullptr;
    Vec3f normal_;
    double predicted_[3] = {0, 0, 0};
    double spreadSum_ = 0;
    std::vector<RegionGroup> groups_;
    std::vector<Lanes> lanes_;
};

}  // namespace shadowcache
