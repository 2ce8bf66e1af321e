#include "render/regions/lobe_integrand.h"

#include <algorithm>
#include <cmath>

#include "common/base/tuned.h"
#include "common/predict/lanes.h"

namespace shadowcache {

namespace {

/// Share of a lobe that the light of every region counts with at least, as if it were spread over
/// the hemisphere: other points' lobes, and what lies between a region's places, may reflect more.
SHADOWCACHE_TUNED(float, kPlainShare, 0.2f);

/// Mean square of a fit's error, as a share of the fit's own, from which on it is of no use.
SHADOWCACHE_TUNED(float, kWorstFit, 0.25f);

constexpr int kWithin = QuadraticBlock::kPlaces - QuadraticBlock::kNodes;

void measure(const QuadraticBlock& cells, const PlaceValues& values, const QuadraticFit& fit,
             const Rgb& weights, LobeIntegrand::Moments& out) {
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
                     QuadraticFit& fit, LobeIntegrand::Moments& lobe) {
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

/// Sum over the regions of `visibility(group, lane)` times the integral of L q.
template <class Visibility>
Rgb integrate(const QuadraticCells& cells, const FittedRegions<LobeIntegrand>& fitted,
              const Visibility& visibility) {
    double sum[3] = {};
    for (std::size_t g = 0; g < fitted.fits.size(); ++g) {
        const RegionGroup& group = fitted.regions.groups[g];
        alignas(64) float c[kBlockCells], integral[3][kBlockCells];
        for (int i = 0; i < kBlockCells; ++i) c[i] = visibility(g, i);
        if (maximumOf(c) == 0) continue;
        integrateQuadratic(cells.block(group.level, group.firstCell / kBlockCells), fitted.fits[g],
                           integral);
        for (int k = 0; k < 3; ++k) {
            for (int i = 0; i < kBlockCells; ++i) integral[k][i] *= c[i];
            sum[k] += static_cast<double>(sumOf(integral[k]));
        }
    }
    return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
}

}  // namespace

LobeIntegrand::LobeIntegrand(const Environment& environment, const QuadraticCells& cells,
                             const DirectionTiers& tiers, float leastNoise, const GlossyLobe& lobe,
                             float misfit)
    : environment_(environment),
      cells_(cells),
      refinements_(tiers.refinements()),
      leastNoise_(leastNoise / static_cast<float>(kPi)),
      lobe_(lobe),
      misfit_(misfit),
      mirrored_(lobe.mirrored()),
      peak_(std::max(0.0f, environment.luminance(lobe.value(mirrored_)))),
      // The lobe holds about 4 pi alpha^2 peak of white light.
      plain_(kPlainShare * 4 * lobe.alpha() * lobe.alpha() * peak_) {}

bool LobeIntegrand::look(const CellBlock& block, Scratch& scratch) const {
    const QuadraticBlock& cells = cells_.block(block.level, block.number);
    const Rgb& weights = environment_.luminanceWeights();
    PlaceValues values;
    for (int p = 0; p < QuadraticBlock::kPlaces; ++p) lobe_.values(cells.place[p], values[p]);
    fitQuadratic(cells, values, scratch.fit);
    measure(cells, values, scratch.fit, weights, scratch.moments);
    replacePoorFits(cells, values, weights, scratch.fit, scratch.moments);
    return true;
}

void LobeIntegrand::split(const CellBlock& block, const CellVisibility& v,
                          const PooledVisibility& pooled, Scratch& scratch, Splits& splits) const {
    const CellMoments& m = block.light;
    const Moments& lobe = scratch.moments;
    const bool divisible = block.level < cells_.finest();
    const bool refined = block.tier < refinements_;
    splits.any = false;
    for (int i = 0; i < kBlockCells; ++i) {
        splits.marks[i] = 0;
        const float light = m.luminanceIntegral[i];
        if (!divisible || !(light > 0)) continue;
        const float height =
            mirrored_.x * m.axis[0][i] + mirrored_.y * m.axis[1][i] + mirrored_.z * m.axis[2][i];
        // A narrow lobe may pass between a cell's places.
        const float radius = m.sinRadius[i];
        const bool hasPeak = height > 0 && height * height > 1 - radius * radius;
        const float narrow = std::min(1.0f, lobe_.alpha() / radius);
        const float peak = hasPeak ? peak_ * narrow : 0.0f;
        const float error = lobe.error[i] + peak * peak * (1 - narrow);
        const float least = leastNoise_ / light;
        const float least2 = least * least, c = v.c[i];
        const bool mixed = refined && (lobe.square[i] + peak * peak) * c * (1 - c) > least2 &&
                           pooled.hasChildren(block.tier, block.number * kBlockCells +
                                                              static_cast<std::uint32_t>(i));
        if (!mixed && !(error * c * c > least2)) continue;
        splits.marks[i] = 1;
        splits.any = true;
    }
}

void LobeIntegrand::describe(const CellBlock& block, const Splits& splits, Scratch& scratch,
                             RegionEvidence& e) const {
    const CellMoments& m = block.light;
    const Moments& lobe = scratch.moments;
    const Vec3f& n = lobe_.normal();
    e.countedBrightness = true;
    for (int i = 0; i < kBlockCells; ++i) {
        const float height = n.x * m.axis[0][i] + n.y * m.axis[1][i] + n.z * m.axis[2][i];
        const bool above = height > -m.sinRadius[i] && splits.marks[i] == 0;
        const float light = above ? m.luminanceIntegral[i] : 0.0f;
        const float error = lobe.error[i] + misfit_ * lobe.square[i];
        const bool fits = error < kWorstFit * lobe.fit[i];
        e.luminance[i] = light;
        e.moment[i] = fits ? lobe.fit[i] + error : lobe.square[i];
        e.fitMoment[i] = fits ? lobe.fit[i] : 0.0f;
        e.light[i] = light * std::sqrt(lobe.square[i] + plain_ * plain_);
        e.reflected[i] = e.sure[i] = light * std::sqrt(lobe.square[i]);
        e.fitted[i] = e.exact[i] = fits ? 1.0f : 0.0f;
    }
}

void LobeIntegrand::fit(const CellBlock&, const Scratch& scratch, Fit& out) const {
    out = scratch.fit;
}

Rgb integralOf(const QuadraticCells& cells, const FittedRegions<LobeIntegrand>& fitted,
               const RegionShares& shares) {
    return integrate(cells, fitted, [&](std::size_t g, int i) {
        return shares.groups[g].weight[i] > 0 ? shares.groups[g].visibility[i] : 0.0f;
    });
}

Rgb predictionOf(const QuadraticCells& cells, const FittedRegions<LobeIntegrand>& fitted) {
    return integrate(cells, fitted, [&](std::size_t g, int i) {
        const RegionGroup& group = fitted.regions.groups[g];
        return group.light[i] > 0 ? group.cached[i] : 0.0f;
    });
}

}  // namespace shadowcache
