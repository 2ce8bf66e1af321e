#pragma once

#include <cstdint>
#include <vector>

#include "common/light/environment.h"
#include "common/predict/cell_splits.h"
#include "common/predict/pooled_visibility.h"
#include "render/cached/reliability.h"

namespace shadowcache {

/// Sixteen consecutive cells of one level, as a group of regions to draw samples from. Cells that
/// are no regions (below the horizon, dark, or split further) have no spread.
struct RegionGroup {
    std::uint32_t firstCell;
    int level;
    float spreadSum;
    float spreadMax;
    float predicted[3];  ///< sum over the regions of c_r (n . V_r)
    bool anyShared = false;
};

/// Mean square of the residual in a region that is visible with probability `a` and that the
/// control variate says is visible by `c`, in units of its light. The two moments are those of the
/// clamped cosine and of what stands in for it; both 1 above the horizon.
inline float residualMoment(float a, float c, float cosineMoment, float fitMoment) {
    return a * (cosineMoment - fitMoment) + fitMoment * (a * (1 - c) * (1 - c) + (1 - a) * c * c);
}

/// The regions of one shading point: what the cache predicts of each, and how unsure it is.
/// [docs/estimator.md] Arrays are reused from point to point.
class RegionWeights {
public:
    RegionWeights(const Environment& environment, const DirectionTiers& tiers);

    /// Splits the hemisphere around `normal` into regions by the pooled counts, as far as they can
    /// be trusted: the control variate's integral goes to predicted(), the groups to group().
    void weigh(const PooledVisibility& pooled, const Vec3f& normal, const Reliability& reliability);

    /// Marks the regions whose surprises are to be shared with neighbouring points: those where one
    /// of `samples` samples against the cache's word would weigh a good part of the irradiance and
    /// `darkest` together; what is predicted but not sure counts `unsureShare` in that. There the
    /// word is rounded to fully hidden or fully open, and fewer samples do, because the neighbours'
    /// count as well.
    void shareSurprises(double samples, double darkest, double unsureShare);

    /// Sum over the regions of c_r (n . V_r): the irradiance the cache predicts.
    const double* predicted() const { return predicted_; }
    double predictedLuminance() const;
    /// Sum of all spreads: about the standard deviation of one sample drawn in proportion to them,
    /// as far as the counts tell.
    double spreadSum() const { return spreadSum_; }

    std::size_t size() const { return groups_.size(); }
    const RegionGroup& group(std::size_t g) const { return groups_[g]; }
    /// Weight of each region of the group in the choice of a sample's region: the predicted
    /// standard deviation of the residual there, and a defensive share of the light. After
    /// RegionSampler::draw() the numbers of samples; the sums are those of before.
    float* spread(std::size_t g) { return lanes_[g].spread; }
    const float* spread(std::size_t g) const { return lanes_[g].spread; }
    /// c_r: the visibility that the control variate assumes.
    const float* visibility(std::size_t g) const { return lanes_[g].visibility; }
    /// 1 where finding the sky is a surprise to share, -1 where finding an occluder is, else 0.
    const float* shared(std::size_t g) const { return lanes_[g].shared; }
    /// Light of the region as far as nothing hides it.
    const float* light(std::size_t g) const { return lanes_[g].light; }
    /// Probability that light of the region is seen, as the counts and the hierarchy have it.
    const float* posterior(std::size_t g) const { return lanes_[g].posterior; }

private:
    struct alignas(64) Lanes {
        float spread[kBlockCells];
        float visibility[kBlockCells];
        float posterior[kBlockCells];
        float light[kBlockCells];  ///< unshadowed
        float flat[kBlockCells];   ///< 1 where the horizon does not cut the region, else 0
        float shared[kBlockCells];
    };
    /// What a cell hands down to its children.
    struct Parent {
        float visibility;
        float posterior;
    };
    void roundShared(std::size_t g);
    void addPredicted(const RegionGroup& group);
    /// Mixes a share of the light itself into the spreads.
    void defend();
    void weighBlock(int tier, std::uint32_t block, const PooledBlock* counts, const Parent& parent);

    const Environment& environment_;
    DirectionTiers tiers_;
    CellSplitter splitter_;
    const PooledVisibility* pooled_ = nullptr;
    const Reliability* reliability_ = nullptr;
    Vec3f normal_;
    double predicted_[3] = {0, 0, 0};
    double spreadSum_ = 0;
    double lightSum_ = 0;   ///< of all regions, unshadowed
    double sureLight_ = 0;  ///< of the regions that are almost surely open
    std::vector<RegionGroup> groups_;
    std::vector<Lanes> lanes_;
};

}  // namespace shadowcache
