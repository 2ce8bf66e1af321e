#pragma once

#include <vector>

#include "common/base/tuned.h"
#include "render/regions/regions.h"

namespace shadowcache {

/// What is drawn from the sixteen regions of a RegionGroup, and against which prediction.
struct alignas(64) GroupShares {
    /// Sampling weight: chance of a region in the choice of a sample's, times the sum of all
    /// weights.
    alignas(64) float weight[kBlockCells];
    /// c as the control variate has it.
    alignas(64) float visibility[kBlockCells];
    /// 1 where to find the sky is a misprediction that other points reuse, -1 where to find an
    /// occluder is, 0 where samples count for their own point alone.
    alignas(64) float reuse[kBlockCells];
    double weightSum = 0;
    bool anyReuse = false;
};

/// How the samples of a cluster are shared out over its regions: decided by predictions alone,
/// before any ray.
struct RegionShares {
    std::vector<GroupShares> groups;  ///< as Regions::groups
    double weightSum = 0;
};

/// How bright a place is beside a sample.
struct Brightness {
    double darkest = 0;      ///< irradiance below which errors count no more [luminance]
    double unsureShare = 0;  ///< how much of the light that is predicted but not sure counts
};

/// Brightness::unsureShare with the uniform budget, which gives no more samples to places that turn
/// out dark.
inline constexpr double kUnsureShareUniform = 0.2;

/// Whatever number of samples is asked for, the same regions are reused as with so many: what is
/// not reused then falls as all the noise does.
inline SHADOWCACHE_TUNED(double, kJudgedSamples, 64);

/// Samples of the irradiance drawn in proportion to the light alone, for each that follows the
/// counts: bounds what light can weigh that was predicted occluded.
inline SHADOWCACHE_TUNED(double, kDefensiveShare, 0.2);

/// Samples of the irradiance drawn in proportion to the light that is almost surely seen, for each
/// that follows the counts: bounds what that light can weigh where a near wall hides it.
inline SHADOWCACHE_TUNED(double, kPredictedShare, 0.2);

/// Constants of the shares.
struct ShareRules {
    /// Samples drawn in proportion to the light alone, for each that follows the counts.
    double defensiveShare = kDefensiveShare;
    /// Samples drawn in proportion to the light that is almost surely seen, for each that follows
    /// the counts.
    double predictedShare = kPredictedShare;
    /// Predicted visibility from which on reuse expects the sky.
    float mostlyVisible = kMostlyVisible;
};

/// Weights of regions: by their predicted deviation, and defensive shares of their light.
class RegionWeights {
public:
    RegionWeights(const Regions& regions, const ShareRules& rules);

    double sum() const { return sum_; }
    float of(const RegionGroup& group, int i) const {
        const float sure = group.visibility[i] > kMostlyVisible ? perSureLight_ : 0.0f;
        return group.deviation[i] + (perLight_ + sure) * group.light[i];
    }
    /// What a sample that contradicts the prediction contributes, for each unit of light over
    /// weight, as a part of the brightness of a point with so many samples.
    double heaviness(double samples, const Brightness& brightness) const;

private:
    double sum_;
    const Regions& regions_;
    float perLight_ = 0, perSureLight_ = 0;
};

/// Standard deviation of one sample of a point, as the regions predict it.
double deviationOf(const Regions& regions);

/// Shares samples out by the predicted deviation of regions and a defensive share of their light.
/// Mispredictions are to be reused where one of `samples` samples that contradicts the prediction
/// would contribute more than a small part of the point's brightness; there the prediction is
/// rounded to fully occluded or fully visible, and fewer samples do, since the neighbours' count as
/// well.
class RegionSharer {
public:
    explicit RegionSharer(const ShareRules& rules = {}) : rules_(rules) {}

    /// @param heavy  part of a point's brightness from which on a sample is reused
    /// @return valid until the next call
    const RegionShares& share(const Regions& regions, double samples, const Brightness& brightness,
                              double heavy);

private:
    ShareRules rules_;
    RegionShares shares_;
};

}  // namespace shadowcache
