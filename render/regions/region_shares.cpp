#include "render/regions/region_shares.h"

#include <algorithm>
#include <cmath>

#include "common/base/tuned.h"
#include "common/predict/lanes.h"

namespace shadowcache {

namespace {

/// Regions whose mispredictions are reused need this much of the samples that they would need
/// alone.
SHADOWCACHE_TUNED(float, kReuseWeight, 0.5f);

}  // namespace

double deviationOf(const Regions& regions) {
    return RegionWeights(regions, ShareRules()).sum();
}

RegionWeights::RegionWeights(const Regions& regions, const ShareRules& rules)
    : sum_((1 + rules.defensiveShare) * regions.deviationSum), regions_(regions) {
    if (regions.lightSum > 0)
        perLight_ =
            static_cast<float>(rules.defensiveShare * regions.deviationSum / regions.lightSum);
    const double predicted = std::max(regions.surelyVisible, regions.predictedLuminance);
    if (!(predicted > 0)) return;
    const double perSureLight = rules.predictedShare * regions.deviationSum / predicted;
    perSureLight_ = static_cast<float>(perSureLight);
    sum_ += perSureLight * regions.surelyVisible;
}

double RegionWeights::heaviness(double samples, const Brightness& brightness) const {
    const double unsure = std::max(0.0, regions_.predictedLuminance - regions_.surelyVisible);
    const double bright =
        brightness.darkest + regions_.surelyVisible + brightness.unsureShare * unsure;
    return sum_ / (bright * samples);
}

const RegionShares& RegionSharer::share(const Regions& regions, double samples,
                                        const Brightness& brightness, double heavy) {
    shares_.groups.resize(regions.groups.size());
    shares_.weightSum = 0;
    if (!(regions.lightSum > 0)) return shares_;
    const RegionWeights weights(regions, rules_);
    const auto least = static_cast<float>(heavy / weights.heaviness(samples, brightness));
    for (std::size_t g = 0; g < regions.groups.size(); ++g) {
        const RegionGroup& from = regions.groups[g];
        GroupShares& to = shares_.groups[g];
        alignas(64) float marked[kBlockCells];
        for (int i = 0; i < kBlockCells; ++i) {
            const float weight = weights.of(from, i);
            const float isHeavy = from.light[i] > least * weight ? 1.0f : 0.0f;
            const float sign = from.visibility[i] < rules_.mostlyVisible ? 1.0f : -from.exact[i];
            to.reuse[i] = isHeavy * sign;
            marked[i] = std::abs(to.reuse[i]);
            to.weight[i] = weight * (1 - marked[i] * (1 - kReuseWeight));
            const float rounded = to.reuse[i] > 0 ? 0.0f : 1.0f;
            to.visibility[i] = marked[i] > 0 ? rounded : from.visibility[i];
        }
        to.anyReuse = maximumOf(marked) > 0;
        to.weightSum = 0;
        for (int i = 0; i < kBlockCells; ++i) to.weightSum += static_cast<double>(to.weight[i]);
        shares_.weightSum += to.weightSum;
    }
    return shares_;
}

}  // namespace shadowcache
