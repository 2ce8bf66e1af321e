#include "render/region_weights.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace shadowcache {

namespace {

/// How strongly a region's parent counts beside its own rays, in rays.
constexpr float kPriorRays = 0.5f;

/// What the sky adds through each of sixteen cells, and where they stand to the horizon.
struct CellLight {
    alignas(64) float flux[3][kBlockCells];  ///< n . V_r
    alignas(64) float light[kBlockCells];    ///< its luminance
    alignas(64) float height[kBlockCells];   ///< n . axis
};

void lightCells(const CellMoments& m, const Vec3f& n, const Rgb& weights, CellLight& out) {
    for (int i = 0; i < kBlockCells; ++i) {
        out.height[i] = n.x * m.axis[0][i] + n.y * m.axis[1][i] + n.z * m.axis[2][i];
        const float r = n.x * m.flux[0][0][i] + n.y * m.flux[0][1][i] + n.z * m.flux[0][2][i];
        const float g = n.x * m.flux[1][0][i] + n.y * m.flux[1][1][i] + n.z * m.flux[1][2][i];
        const float b = n.x * m.flux[2][0][i] + n.y * m.flux[2][1][i] + n.z * m.flux[2][2][i];
        out.flux[0][i] = r;
        out.flux[1][i] = g;
        out.flux[2][i] = b;
        out.light[i] = weights.x * r + weights.y * g + weights.z * b;
    }
}

/// c and the posterior mean of the visibility in each of sixteen cells.
struct CellVisibility {
    alignas(64) float c[kBlockCells];
    alignas(64) float posterior[kBlockCells];
};

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
      finest_(Environment::kLevel - (tiers.baseLevel() == Environment::kLevel % 2 ? 0 : 1)) {}

void RegionWeights::weigh(const PooledVisibility& pooled, const Vec3f& normal) {
    pooled_ = &pooled;
    normal_ = normal;
    groups_.clear();
    lanes_.clear();
    spreadSum_ = 0;
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
}

void RegionWeights::weighBlock(int tier, std::uint32_t block, const PooledBlock* counts,
                               const Parent& parent) {
    const int level = tiers_.baseLevel() + 2 * tier;
    const CellMoments& m = environment_.cells(level, block);
    CellLight sky;
    lightCells(m, normal_, environment_.luminanceWeights(), sky);
    CellVisibility v;
    estimateVisibility(counts, parent.visibility, parent.posterior, v);

    const bool divisible = level < finest_;
    const std::int16_t* slots =
        tier < tiers_.refinements() ? pooled_->childSlots(tier, block) : nullptr;
    alignas(16) std::uint8_t split[kBlockCells];
    Lanes lanes;
    float predicted[3] = {0, 0, 0};
    for (int i = 0; i < kBlockCells; ++i) {
        const bool above = sky.height[i] >= m.sinRadius[i];
        const bool dark = m.power[i] <= 0 || sky.height[i] <= -m.sinRadius[i];
        // A cell the horizon cuts is split where something is seen in it; where nothing is, the
        // finer cells would say the same.
        const bool cut = !above && v.c[i] > 0;
        const bool finer = slots && slots[i] >= 0;
        const bool splits = !dark && divisible && (finer || cut);
        split[i] = splits;
        const bool region = !dark && !splits;
        // On the horizon nothing is predicted, but light may come.
        const float c = above && region ? v.c[i] : 0.0f;
        const float light =
            above ? sky.light[i]
                  : 0.5f * m.power[i] * std::min(1.0f, sky.height[i] + m.sinRadius[i]);
        const float a = v.posterior[i];
        const float second = a * (1 - c) * (1 - c) + (1 - a) * c * c;
        lanes.visibility[i] = c;
        lanes.spread[i] = region ? light * std::sqrt(second) : 0.0f;
        predicted[0] += c * sky.flux[0][i];
        predicted[1] += c * sky.flux[1][i];
        predicted[2] += c * sky.flux[2][i];
    }
    float sum = 0, most = 0;
    for (int i = 0; i < kBlockCells; ++i) {
        sum += lanes.spread[i];
        most = std::max(most, lanes.spread[i]);
    }
    for (int k = 0; k < 3; ++k) predicted_[k] += static_cast<double>(predicted[k]);
    if (sum > 0) {
        groups_.push_back({block * kBlockCells, level, sum, most});
        lanes_.push_back(lanes);
        spreadSum_ += static_cast<double>(sum);
    }
    std::uint64_t marks[2];
    std::memcpy(marks, split, sizeof marks);
    for (int half = 0; half < 2; ++half)
        for (std::uint64_t left = marks[half]; left; left &= left - 1) {
            const int i = 8 * half + std::countr_zero(left) / 8;
            const std::uint32_t cell = block * kBlockCells + static_cast<std::uint32_t>(i);
            const PooledBlock* finer =
                slots && slots[i] >= 0 ? pooled_->children(tier, cell) : nullptr;
            weighBlock(tier + 1, cell, finer, {v.c[i], v.posterior[i]});
        }
}

}  // namespace shadowcache
