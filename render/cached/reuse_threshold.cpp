#include "render/cached/reuse_threshold.h"

#include "common/base/tuned.h"
#include "render/cached/neighbor_reuse.h"

namespace shadowcache {

namespace {

/// Part of a group's other points that share in a misprediction, each with about the density of its
/// finder.
SHADOWCACHE_TUNED(double, kReusingShare, 0.1);

/// Cost of a ray to a neighbour, over that of a sample with its part of the set-up.
SHADOWCACHE_TUNED(double, kReusedRayCost, 0.3);

/// Predicted gain from which on less is reused. What reuse gains is predicted too low: in the grove
/// the error rose 1.4 to 1.8 times without it, where 1.2 was predicted.
SHADOWCACHE_TUNED(double, kClearGain, 1.3);

}  // namespace

void ReuseThreshold::add(std::size_t choice, const Regions& regions, const SamplingPlan& plan,
                         double share, double weight) {
    double variance = 0, rays = 0;  // of one sample
    for (std::size_t g = 0; g < plan.groups.size(); ++g) {
        const RegionGroup& group = regions.groups[g];
        const PlannedGroup& planned = plan.groups[g];
        for (int i = 0; i < kBlockCells; ++i) {
            if (!(planned.weight[i] > 0)) continue;
            const double probability = static_cast<double>(planned.weight[i]) / plan.weightSum;
            if (planned.reuse[i] == 0) {
                const auto deviation = static_cast<double>(group.deviation[i]);
                variance += deviation * deviation / probability;
                continue;
            }
            const double chance = mispredictionChance(group, planned, i);
            const double others = reuseGroupSize(chance) - 1;
            const auto light = static_cast<double>(group.light[i]);
            variance += light * light * chance / (probability * (1 + kReusingShare * others));
            rays += probability * chance * others;
        }
    }
    error_[choice] += weight * variance / share;
    cost_[choice] += share * (1 + kReusedRayCost * rays);
}

void ReuseThreshold::add(const ReuseThreshold& other) {
    for (std::size_t i = 0; i < kChoices.size(); ++i) {
        error_[i] += other.error_[i];
        cost_[i] += other.cost_[i];
    }
}

double ReuseThreshold::best() const {
    return kChoices[kClearGain * error_[1] * cost_[1] < error_[0] * cost_[0] ? 1 : 0];
}

}  // namespace shadowcache
