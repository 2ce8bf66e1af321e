#include "render/cached/glossy_regions.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/tuned.h"
#include "common/predict/lanes.h"
#include "render/cached/cell_visibility.h"

namespace shadowcache {

namespace {

/// Share of a lobe that the light of every region counts with at least, as if it were spread over
/// the hemisphere: other points' lobes, and what lies between a region's places, may reflect more.
SHADOWCACHE_TUNED(float, kPlainShare, 0.2f);

/// Mean square of a fit's error, as a share of the fit's own, from which on it is of no use.
SHADOWCACHE_TUNED(float, kWorstFit, 0.25f);

constexpr int kWithin = QuadraticBlock::kPlaces - QuadraticBlock::kNodes;

/// Means over sixteen cells, of the luminance that a lobe reflects of white light. [1/sr]
struct LobeMoments {
    alignas(64) float square[kBlockCells];  ///< of the lobe^2
    alignas(64) float fit[kBlockCells];     ///< of its fit^2
    alignas(64) float error[kBlockCells];   ///< of the difference^2
};

void measure(const QuadraticBlock& cells, const PlaceValues& values, const QuadraticFit& fit,
             const Rgb& weights, LobeMoments& out) {
    for (int i = 0; i < kBlockCells; ++i) out.square[i] = out.fit[i] = out.error[i] = 0;
    alignas(64) float fitted[3][kBlockCells];
    for (int p = 0; p < kWithin; ++p) {
        const auto& value = values[QuadraticBlock::kNodes + p];
        for (int k = 0; k < 3; ++k) fitWithin(cells, fit, p, k, fitted[k]);
        for (int i = 0; i < kBlockCells; ++i) {
            const float f =
                weights.x * value[0][i] + weights.y * value[1][i] + weights.z * value[2][i];
            const float q =
                weights.x * fitted[0][i] + weights.y * fitted[1][i] + weights.z * fitted[2][i];
            out.square[i] += f * f / kWithin;
            out.fit[i] += q * q / kWithin;
            out.error[i] += (f - q) * (f - q) / kWithin;
        }
    }
}

/// Where the quadratic follows the lobe badly, the lobe's mean stands in.
void replacePoorFits(const QuadraticBlock& cells, const PlaceValues& values, const Rgb& weights,
                     QuadraticFit& fit, LobeMoments& lobe) {
    for (int i = 0; i < kBlockCells; ++i) {
        if (lobe.error[i] <= kWorstFit * lobe.fit[i]) continue;
        Rgb mean(0.0f);
        for (int p = 0; p < kWithin; ++p)
            for (int k = 0; k < 3; ++k)
                mean[k] += values[QuadraticBlock::kNodes + p][k][i] / kWithin;
        setConstant(cells, i, mean, fit);
        const float y = weights.x * mean.x + weights.y * mean.y + weights.z * mean.z;
        lobe.fit[i] = y * y;
        lobe.error[i] = std::max(0.0f, lobe.square[i] - y * y);
    }
}

}  // namespace

/// What all blocks of one cluster share.
struct GlossyRegionBuilder::Task {
    const QuadraticCells& cells;
    const PooledVisibility& pooled;
    const Calibration& calibration;
    const GlossyLobe& lobe;
    float misfit;
    Vec3f mirrored;
    float peak;   ///< of the lobe, about [luminance]
    float plain;  ///< what a region's lobe is taken for, at least
};

const GlossyRegions& GlossyRegionBuilder::build(const QuadraticCells& cells,
                                                const PooledVisibility& pooled,
                                                const GlossyLobe& lobe, float misfit,
                                                const Calibration& calibration) {
    std::vector<RegionGroup> groups = std::move(result_.regions.groups);
    groups.clear();
    result_.regions = {std::move(groups)};
    result_.fits.clear();
    result_.predicted.clear();
    const Vec3f mirrored = lobe.mirrored();
    const float peak = std::max(0.0f, environment_.luminance(lobe.value(mirrored)));
    // The lobe holds about 4 pi alpha^2 peak of white light.
    const float plain = kPlainShare * 4 * lobe.alpha() * lobe.alpha() * peak;
    const Task task{cells, pooled, calibration, lobe, misfit, mirrored, peak, plain};
    const ParentVisibility sphere = sphereVisibility(pooled);
    for (std::uint32_t b = 0; b < pooled.baseBlocks(); ++b)
        addBlock(task, 0, b, &pooled.base(b), sphere);
    return result_;
}

void GlossyRegionBuilder::addBlock(const Task& task, int tier, std::uint32_t block,
                                   const PooledBlock* counts, const ParentVisibility& parent) {
    const int level = tiers_.baseLevel() + 2 * tier;
    const CellMoments& m = environment_.cells(level, block);
    const QuadraticBlock& cells = task.cells.block(level, block);
    const Rgb& weights = environment_.luminanceWeights();
    PlaceValues values;
    for (int p = 0; p < QuadraticBlock::kPlaces; ++p) task.lobe.values(cells.place[p], values[p]);
    QuadraticFit fit;
    fitQuadratic(cells, values, fit);
    LobeMoments lobe;
    measure(cells, values, fit, weights, lobe);
    replacePoorFits(cells, values, weights, fit, lobe);
    CellVisibility v;
    estimateVisibility(counts, parent, v);

    const bool divisible = level < task.cells.finest();
    const bool refined = tier < tiers_.refinements();
    alignas(64) float isSplit[kBlockCells];
    for (int i = 0; i < kBlockCells; ++i) {
        isSplit[i] = 0;
        const float light = m.luminanceIntegral[i];
        if (!divisible || !(light > 0)) continue;
        const float height = task.mirrored.x * m.axis[0][i] + task.mirrored.y * m.axis[1][i] +
                             task.mirrored.z * m.axis[2][i];
        // A narrow lobe may pass between a cell's places.
        const float radius = m.sinRadius[i];
        const bool hasPeak = height > 0 && height * height > 1 - radius * radius;
        const float narrow = std::min(1.0f, task.lobe.alpha() / radius);
        const float peak = hasPeak ? task.peak * narrow : 0.0f;
        const float error = lobe.error[i] + peak * peak * (1 - narrow);
        const float least = leastNoise_ / light;
        const float least2 = least * least, c = v.c[i];
        const bool mixed =
            refined && (lobe.square[i] + peak * peak) * c * (1 - c) > least2 &&
            task.pooled.hasChildren(tier, block * kBlockCells + static_cast<std::uint32_t>(i));
        isSplit[i] = mixed || error * c * c > least2 ? 1.0f : 0.0f;
    }

    RegionGroup& group = result_.regions.groups.emplace_back();
    group.firstCell = block * kBlockCells;
    group.level = level;
    group.cut = false;
    alignas(64) float correction[kBlockCells], sure[kBlockCells], predicted[kBlockCells];
    task.calibration.apply<kBlockCells>(v.posterior, group.calibrated, correction);
    std::array<float, kBlockCells> seen;
    const Vec3f& n = task.lobe.normal();
    for (int i = 0; i < kBlockCells; ++i) {
        const float height = n.x * m.axis[0][i] + n.y * m.axis[1][i] + n.z * m.axis[2][i];
        const bool above = height > -m.sinRadius[i] && isSplit[i] == 0;
        const float light = above ? m.luminanceIntegral[i] : 0.0f;
        const float error = lobe.error[i] + task.misfit * lobe.square[i];
        const bool fits = error < kWorstFit * lobe.fit[i];
        const float cached = corrected(v.c[i], correction[i]);
        seen[static_cast<std::size_t>(i)] = light > 0 ? cached : 0.0f;
        const float c = fits ? cached : 0.0f;
        const float moment = fits ? lobe.fit[i] + error : lobe.square[i];
        group.visibility[i] = c;
        group.posterior[i] = v.posterior[i];
        const float reflected = light * std::sqrt(lobe.square[i]);
        group.light[i] = light * std::sqrt(lobe.square[i] + task.plain * task.plain);
        predicted[i] = reflected * v.c[i];
        group.deviation[i] = light * std::sqrt(residualMoment(group.calibrated[i], c, moment,
                                                              fits ? lobe.fit[i] : 0.0f));
        group.above[i] = fits ? 1.0f : 0.0f;
        group.constant[i] = group.linear[i] = group.square[i] = 0;
        sure[i] = v.c[i] > kMostlyVisible ? reflected : 0.0f;
    }
    if (maximumOf(group.light) > 0) {
        result_.fits.push_back(fit);
        result_.predicted.push_back(seen);
        Regions& regions = result_.regions;
        regions.deviationSum += static_cast<double>(sumOf(group.deviation));
        regions.lightSum += static_cast<double>(sumOf(group.light));
        regions.surelyVisible += static_cast<double>(sumOf(sure));
        regions.predictedLuminance += static_cast<double>(sumOf(predicted));
    } else {
        result_.regions.groups.pop_back();
    }
    for (std::uint32_t i = 0; i < kBlockCells; ++i) {
        if (isSplit[i] == 0) continue;
        const std::uint32_t cell = block * kBlockCells + i;
        addBlock(task, tier + 1, cell, task.pooled.children(tier, cell), {v.c[i], v.posterior[i]});
    }
}

namespace {

/// Sum over the regions of `visibility(group, lane)` times the integral of L q.
template <class Visibility>
Rgb integrate(const QuadraticCells& cells, const GlossyRegions& glossy,
              const Visibility& visibility) {
    double sum[3] = {};
    for (std::size_t g = 0; g < glossy.fits.size(); ++g) {
        const RegionGroup& group = glossy.regions.groups[g];
        alignas(64) float c[kBlockCells], integral[3][kBlockCells];
        for (int i = 0; i < kBlockCells; ++i) c[i] = visibility(g, i);
        if (maximumOf(c) == 0) continue;
        integrateQuadratic(cells.block(group.level, group.firstCell / kBlockCells), glossy.fits[g],
                           integral);
        for (int k = 0; k < 3; ++k) {
            for (int i = 0; i < kBlockCells; ++i) integral[k][i] *= c[i];
            sum[k] += static_cast<double>(sumOf(integral[k]));
        }
    }
    return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
}

}  // namespace

Rgb integralOf(const QuadraticCells& cells, const GlossyRegions& glossy, const SamplingPlan& plan) {
    return integrate(cells, glossy, [&](std::size_t g, int i) {
        return plan.groups[g].weight[i] > 0 ? plan.groups[g].visibility[i] : 0.0f;
    });
}

Rgb predictionOf(const QuadraticCells& cells, const GlossyRegions& glossy) {
    return integrate(cells, glossy, [&](std::size_t g, int i) {
        return glossy.predicted[g][static_cast<std::size_t>(i)];
    });
}

}  // namespace shadowcache
