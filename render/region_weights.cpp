#include "render/region_weights.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "render/horizon.h"

namespace shadowcache {

/// What the sky adds through each of sixteen cells. Above the horizon the cosine is that of the
/// light itself; below it nothing comes; across it a quadratic stands in for the clamped cosine.
struct CellLight {
    alignas(64) float flux[3][kBlockCells];       ///< integral of the light times the cosine
    alignas(64) float light[kBlockCells];         ///< scale of a sample's contribution
    alignas(64) float cosineMoment[kBlockCells];  ///< mean of clamped cosine^2, in light^2
    alignas(64) float fitMoment[kBlockCells];     ///< mean of its stand-in^2, likewise
    bool anyHorizon;
};

/// c and the posterior mean of the visibility in each of sixteen cells.
struct CellVisibility {
    alignas(64) float c[kBlockCells];
    alignas(64) float posterior[kBlockCells];
};

namespace {

/// How strongly a region's parent counts beside its own rays, in rays.
constexpr float kPriorRays = 0.5f;

/// A cell is split where as a whole it would add more noise than this, as a share of the sky's
/// light: because part of it is hidden, or because the quadratic that stands for the clamped cosine
/// on the horizon is not the cosine.
constexpr float kLeastNoise = 5e-4f;

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

/// Folds sixteen numbers into one, in a fixed order that SIMD registers like.
template <class Fold>
float foldLanes(const float* x, Fold fold) {
    float half[8], quarter[4];
    for (int i = 0; i < 8; ++i) half[i] = fold(x[i], x[i + 8]);
    for (int i = 0; i < 4; ++i) quarter[i] = fold(half[i], half[i + 4]);
    return fold(fold(quarter[0], quarter[2]), fold(quarter[1], quarter[3]));
}

float sumOf(const float* x) {
    return foldLanes(x, [](float a, float b) { return a + b; });
}

float maximumOf(const float* x) {
    return foldLanes(x, [](float a, float b) { return a > b ? a : b; });
}

float minimumOf(const float* x) {
    return foldLanes(x, [](float a, float b) { return a < b ? a : b; });
}

void lightHorizonCell(const CellMoments& m, const Vec3f& n, float height, int i, CellLight& out) {
    const HorizonFit fit(height, m.sinRadius[i]);
    for (int k = 0; k < 3; ++k) {
        const float(*s)[kBlockCells] = m.second[k];
        const float total = s[0][i] + s[1][i] + s[2][i];
        const float first = n.x * m.flux[k][0][i] + n.y * m.flux[k][1][i] + n.z * m.flux[k][2][i];
        const float second = n.x * n.x * s[0][i] + n.y * n.y * s[1][i] + n.z * n.z * s[2][i] +
                             2 * (n.x * n.y * s[3][i] + n.x * n.z * s[4][i] + n.y * n.z * s[5][i]);
        out.flux[k][i] = fit.constant * total + fit.linear * first + fit.square * second;
    }
    out.light[i] = m.power[i];
    out.cosineMoment[i] = fit.cosineMoment;
    out.fitMoment[i] = fit.fitMoment;
}

void lightCells(const CellMoments& m, const Vec3f& n, const Rgb& weights, CellLight& out) {
    alignas(64) float height[kBlockCells], distance[kBlockCells];
    for (int i = 0; i < kBlockCells; ++i) {
        height[i] = n.x * m.axis[0][i] + n.y * m.axis[1][i] + n.z * m.axis[2][i];
        const float above = height[i] > 0 ? 1.0f : 0.0f;
        const float r = n.x * m.flux[0][0][i] + n.y * m.flux[0][1][i] + n.z * m.flux[0][2][i];
        const float g = n.x * m.flux[1][0][i] + n.y * m.flux[1][1][i] + n.z * m.flux[1][2][i];
        const float b = n.x * m.flux[2][0][i] + n.y * m.flux[2][1][i] + n.z * m.flux[2][2][i];
        out.flux[0][i] = above * r;
        out.flux[1][i] = above * g;
        out.flux[2][i] = above * b;
        out.light[i] = above * (weights.x * r + weights.y * g + weights.z * b);
        out.cosineMoment[i] = 1;
        out.fitMoment[i] = 1;
        distance[i] = std::abs(height[i]) - m.sinRadius[i];
    }
    out.anyHorizon = minimumOf(distance) < 0;
    if (!out.anyHorizon) return;
    for (int i = 0; i < kBlockCells; ++i)
        if (std::abs(height[i]) < m.sinRadius[i]) lightHorizonCell(m, n, height[i], i, out);
}

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
        const float c = std::min(counts->open[i] / std::max(counts->weight[i], 1e-30f), 1.0f);
        out.c[i] = c;
        out.posterior[i] = (c * rays + kPriorRays * parentPosterior) / (rays + kPriorRays);
    }
}

}  // namespace

RegionWeights::RegionWeights(const Environment& environment, const DirectionTiers& tiers)
    : environment_(environment),
      tiers_(tiers),
      finest_(Environment::kLevel - (tiers.baseLevel() == Environment::kLevel % 2 ? 0 : 1)),
      leastNoise_(kLeastNoise * static_cast<float>(environment.totalPower())) {}

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
            predicted[i] = lanes.light[i] > 0 ? lanes.visibility[i] * sky.flux[k][i] : 0.0f;
        groups_[g].predicted[k] = sumOf(predicted);
    }
}

bool RegionWeights::markSplits(int tier, std::uint32_t block, const CellLight& sky,
                               const CellVisibility& v, std::uint8_t* split) const {
    const bool divisible = tiers_.baseLevel() + 2 * tier < finest_;
    const bool refined = tier < tiers_.refinements();
    if (!divisible || !(refined || sky.anyHorizon)) return false;
    const float scale = 1 / leastNoise_;
    alignas(16) std::uint8_t doubtful[kBlockCells];
    for (int i = 0; i < kBlockCells; ++i) {
        const float power = sky.light[i] * scale * (sky.light[i] * scale);
        const float doubt = power * v.c[i] * (1 - v.c[i]);
        const float noise = power * v.c[i] * v.c[i] * (sky.cosineMoment[i] - sky.fitMoment[i]);
        doubtful[i] = doubt > 1 ? 1 : 0;
        split[i] = noise > 1 ? 1 : 0;
    }
    for (std::uint32_t i = 0; refined && i < kBlockCells; ++i)
        if (doubtful[i] != 0)
            split[i] |=
                static_cast<std::uint8_t>(pooled_->hasChildren(tier, block * kBlockCells + i));
    return std::any_of(split, split + kBlockCells, [](std::uint8_t s) { return s != 0; });
}

void RegionWeights::weighBlock(int tier, std::uint32_t block, const PooledBlock* counts,
                               const Parent& parent) {
    const int level = tiers_.baseLevel() + 2 * tier;
    const CellMoments& m = environment_.cells(level, block);
    CellLight sky;
    lightCells(m, normal_, environment_.luminanceWeights(), sky);
    CellVisibility v;
    estimateVisibility(counts, parent.visibility, parent.posterior, v);

    alignas(16) std::uint8_t split[kBlockCells];
    const bool anySplit = markSplits(tier, block, sky, v, split);
    if (anySplit)
        for (int i = 0; i < kBlockCells; ++i) sky.light[i] = split[i] ? 0.0f : sky.light[i];
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
        predicted[0][i] = share * sky.flux[0][i];
        predicted[1][i] = share * sky.flux[1][i];
        predicted[2][i] = share * sky.flux[2][i];
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
    if (!anySplit) return;
    std::uint64_t marks[2];
    std::memcpy(marks, split, sizeof marks);
    for (int half = 0; half < 2; ++half)
        for (std::uint64_t left = marks[half]; left; left &= left - 1) {
            const int i = 8 * half + std::countr_zero(left) / 8;
            const std::uint32_t cell = block * kBlockCells + static_cast<std::uint32_t>(i);
            const PooledBlock* finer =
                tier < tiers_.refinements() ? pooled_->children(tier, cell) : nullptr;
            weighBlock(tier + 1, cell, finer, {v.c[i], v.posterior[i]});
        }
}

}  // namespace shadowcache
