#include "render/cached/region_weights.h"

#include <algorithm>
#include <cmath>

#include "common/predict/cell_light.h"
#include "common/predict/lanes.h"

namespace shadowcache {

namespace {

/// c and the posterior mean of the visibility in each of sixteen cells.
struct CellVisibility {
    alignas(64) float c[kBlockCells];
    alignas(64) float posterior[kBlockCells];
};

/// How strongly a region's parent counts beside its own rays, in rays.
constexpr float kPriorRays = 0.5f;

/// Samples drawn in proportion to the light alone, for each that follows the counts: bounds what a
/// surprise can weigh.
constexpr double kDefensiveShare = 0.4;

/// Part of the irradiance from which on a sample is heavy enough to be shared: what its rays to the
/// neighbours cost is then well spent.
constexpr double kHeavy = 0.1;

/// Shared regions need this much of the samples that they would need alone.
constexpr float kSharedSpread = 0.5f;

/// Visibility from which on a shared region counts as open until a ray says otherwise. High,
/// because noise in a dark place that was thought bright is seen, and the reverse is not.
constexpr float kMostlyOpen = 0.9f;

void estimateVisibility(const PooledBlock* counts, float parentVisibility, float parentPosterior,
                        CellVisibility& out) {
    if (!counts) {
        for (int i = 0; i < kBlockCells; ++i) {
            out.c[i] = parentVisibility;
            out.posterior[i] = parentPosterior;
        }
        return;
    }
    for (int i = 0; i < kBlockCells; ++i) {
        const float rays = counts->rays[i] * counts->rays[i] / std::max(counts->rays2[i], 1e-30f);
        const float c = counts->ratioOrNone(i);
        out.c[i] = c;
        out.posterior[i] = (c * rays + kPriorRays * parentPosterior) / (rays + kPriorRays);
    }
}

}  // namespace

RegionWeights::RegionWeights(const Environment& environment, const DirectionTiers& tiers)
    : environment_(environment), tiers_(tiers), splitter_(environment, tiers) {}

void RegionWeights::weigh(const PooledVisibility& pooled, const Vec3f& normal,
                          const Reliability& reliability) {
    pooled_ = &pooled;
    reliability_ = &reliability;
    normal_ = normal;
    groups_.clear();
    spreadSum_ = 0;
    lightSum_ = sureLight_ = 0;
    predicted_[0] = predicted_[1] = predicted_[2] = 0;
    float open = 0, counted = 0;
    for (std::uint32_t b = 0; b < pooled.baseBlocks(); ++b)
        for (int i = 0; i < kBlockCells; ++i) {
            open += pooled.base(b).open[i];
            counted += pooled.base(b).weight[i];
        }
    const Parent sphere{0, (open + 0.5f) / (counted + 1)};
    for (std::uint32_t b = 0; b < pooled.baseBlocks(); ++b)
        weighBlock(0, b, &pooled.base(b), sphere);
    if (lightSum_ > 0) defend();
}

double RegionWeights::predictedLuminance() const {
    const Rgb& weights = environment_.luminanceWeights();
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += static_cast<double>(weights[k]) * predicted_[k];
    return sum;
}

void RegionWeights::defend() {
    const auto share = static_cast<float>(kDefensiveShare * spreadSum_ / lightSum_);
    spreadSum_ = 0;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        Lanes& lanes = lanes_[g];
        for (int i = 0; i < kBlockCells; ++i) lanes.spread[i] += share * lanes.light[i];
        groups_[g].spreadSum = sumOf(lanes.spread);
        groups_[g].spreadMax = maximumOf(lanes.spread);
        spreadSum_ += static_cast<double>(groups_[g].spreadSum);
    }
}

void RegionWeights::shareSurprises(double samples, double darkest, double unsureShare) {
    const double unsure = std::max(0.0, predictedLuminance() - sureLight_);
    const double brightness = darkest + sureLight_ + unsureShare * unsure;
    // A sample weighs light / (samples * spread / spreadSum).
    const auto least = static_cast<float>(kHeavy * brightness * samples / spreadSum_);
    spreadSum_ = 0;
    predicted_[0] = predicted_[1] = predicted_[2] = 0;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        Lanes& lanes = lanes_[g];
        alignas(64) float marked[kBlockCells], rounded[kBlockCells];
        for (int i = 0; i < kBlockCells; ++i) {
            const float heavy = lanes.light[i] > least * lanes.spread[i] ? 1.0f : 0.0f;
            const float word = lanes.visibility[i] < kMostlyOpen ? 1.0f : -lanes.flat[i];
            lanes.shared[i] = heavy * word;
            marked[i] = std::abs(lanes.shared[i]);
            const float isRounded = std::abs(lanes.visibility[i] - 0.5f) < 0.5f ? 1.0f : 0.0f;
            rounded[i] = marked[i] * isRounded;
            lanes.spread[i] *= 1 - marked[i] * (1 - kSharedSpread);
        }
        groups_[g].anyShared = maximumOf(marked) > 0;
        if (maximumOf(rounded) > 0) roundShared(g);
        addPredicted(groups_[g]);
        groups_[g].spreadSum = sumOf(lanes.spread);
        groups_[g].spreadMax = maximumOf(lanes.spread);
        spreadSum_ += static_cast<double>(groups_[g].spreadSum);
    }
}

void RegionWeights::addPredicted(const RegionGroup& group) {
    for (int k = 0; k < 3; ++k) predicted_[k] += static_cast<double>(group.predicted[k]);
}

/// Rounds the visibility of the group's shared regions, and the integral with it.
void RegionWeights::roundShared(std::size_t g) {
    Lanes& lanes = lanes_[g];
    CellLight sky;
    lightCells(environment_.cells(groups_[g].level, groups_[g].firstCell / kBlockCells), normal_,
               environment_.luminanceWeights(), sky);
    for (int i = 0; i < kBlockCells; ++i) {
        if (lanes.shared[i] == 0) continue;
        lanes.visibility[i] = lanes.shared[i] > 0 ? 0.0f : 1.0f;
    }
    for (int k = 0; k < 3; ++k) {
        alignas(64) float predicted[kBlockCells];
        for (int i = 0; i < kBlockCells; ++i)
            predicted[i] = lanes.light[i] > 0 ? lanes.visibility[i] * sky.irradiance[k][i] : 0.0f;
        groups_[g].predicted[k] = sumOf(predicted);
    }
}

void RegionWeights::weighBlock(int tier, std::uint32_t block, const PooledBlock* counts,
                               const Parent& parent) {
    const int level = tiers_.baseLevel() + 2 * tier;
    const CellMoments& m = environment_.cells(level, block);
    CellLight sky;
    lightCells(m, normal_, environment_.luminanceWeights(), sky);
    CellVisibility v;
    estimateVisibility(counts, parent.visibility, parent.posterior, v);

    Splits split;
    splitter_.mark(*pooled_, tier, block, sky, v.c, splitter_.leastNoise(), split);
    if (split.any)
        for (int i = 0; i < kBlockCells; ++i) sky.light[i] = split.marks[i] ? 0.0f : sky.light[i];
    if (groups_.size() == lanes_.size()) lanes_.resize(2 * lanes_.size() + 64);
    Lanes& lanes = lanes_[groups_.size()];
    alignas(64) float a[kBlockCells], correction[kBlockCells], predicted[3][kBlockCells];
    alignas(64) float sure[kBlockCells];
    reliability_->judge<kBlockCells>(v.posterior, a, correction);
    for (int i = 0; i < kBlockCells; ++i) {
        const float light = sky.light[i];
        const float moved = v.c[i] + correction[i];
        const float atMost1 = moved < 1 ? moved : 1.0f;
        const float c = atMost1 > 0 ? atMost1 : 0.0f;
        lanes.visibility[i] = c;
        lanes.posterior[i] = v.posterior[i];
        lanes.light[i] = light * std::sqrt(sky.cosineMoment[i]);
        lanes.flat[i] = sky.fitMoment[i] == 1 ? 1.0f : 0.0f;
        lanes.spread[i] =
            light * std::sqrt(residualMoment(a[i], c, sky.cosineMoment[i], sky.fitMoment[i]));
        const float share = light > 0 ? c : 0.0f;
        sure[i] = c > kMostlyOpen ? lanes.light[i] : 0.0f;
        predicted[0][i] = share * sky.irradiance[0][i];
        predicted[1][i] = share * sky.irradiance[1][i];
        predicted[2][i] = share * sky.irradiance[2][i];
    }
    const float sum = sumOf(lanes.spread);
    if (sum > 0) {
        groups_.push_back({block * kBlockCells,
                           level,
                           sum,
                           maximumOf(lanes.spread),
                           {sumOf(predicted[0]), sumOf(predicted[1]), sumOf(predicted[2])}});
        addPredicted(groups_.back());
        spreadSum_ += static_cast<double>(sum);
        lightSum_ += static_cast<double>(sumOf(lanes.light));
        sureLight_ += static_cast<double>(sumOf(sure));
    }
    split.forEach([&](int i) {
        const std::uint32_t cell = block * kBlockCells + static_cast<std::uint32_t>(i);
        weighBlock(tier + 1, cell, pooled_->children(tier, cell), {v.c[i], v.posterior[i]});
    });
}

}  // namespace shadowcache
