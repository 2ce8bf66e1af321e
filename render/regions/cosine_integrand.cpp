#include "render/regions/cosine_integrand.h"

#include <algorithm>
#include <cmath>

#include "common/base/tuned.h"
#include "common/predict/cell_light.h"
#include "common/predict/horizon.h"
#include "common/predict/lanes.h"

namespace shadowcache {

namespace {

/// Mean square, over the tilts of a cluster's normals, of what they change of a cosine, as a share
/// of the widest tilt's square.
constexpr float kTiltMoment = 0.1f;

/// Least height over the horizon at which the share of a tilt in the cosine is evaluated.
constexpr float kLeastTiltHeight = 0.05f;

/// Half of the time that the sixteen regions of a split cell take, in those of a sample: a
/// deviation lower by a part p saves as much as 2 p of the samples.
SHADOWCACHE_TUNED(double, kSplitCost, 0.1);

/// Widens what is known of a block at one normal to all normals within the angle of sine `tilt`:
/// cells below the horizon of the one may be above another's, and cosines differ.
void tiltLight(const CellMoments& m, const Vec3f& n, float tilt, const Splits& splits,
               CellLight& sky) {
    for (int i = 0; i < kBlockCells; ++i) {
        if (splits.any && splits.marks[i]) continue;
        const float height = n.x * m.axis[0][i] + n.y * m.axis[1][i] + n.z * m.axis[2][i];
        const float radius = m.sinRadius[i];
        if (height <= -radius) {
            const float reach = height + radius + tilt;
            if (!(reach > 0) || !(m.luminanceIntegral[i] > 0)) continue;
            sky.light[i] = m.luminanceIntegral[i];
            sky.cosineMoment[i] = std::max(reach * reach / 6, 1e-6f);
            sky.fitMoment[i] = 0;
        } else if (height < radius) {
            sky.cosineMoment[i] += kTiltMoment * tilt * tilt;
        } else {
            const float h = std::max(height, kLeastTiltHeight);
            sky.light[i] *= std::sqrt(1 + tilt * tilt / (3 * h * h));
            if (height < radius + tilt) sky.cosineMoment[i] += kTiltMoment * tilt * tilt / (h * h);
        }
    }
}

/// Whether some cell reaches above the horizon of some normal within the angle of sine `tilt`.
bool isAbove(const CellMoments& m, const Vec3f& n, float tilt) {
    alignas(64) float top[kBlockCells];
    for (int i = 0; i < kBlockCells; ++i)
        top[i] = n.x * m.axis[0][i] + n.y * m.axis[1][i] + n.z * m.axis[2][i] + m.sinRadius[i];
    return maximumOf(top) > -tilt;
}

/// Sum over sixteen cells of weight times value.
double dot(const float* weight, const float* value) {
    alignas(64) float product[kBlockCells];
    for (int i = 0; i < kBlockCells; ++i) product[i] = weight[i] * value[i];
    return static_cast<double>(sumOf(product));
}

}  // namespace

double splitNoise(double fine, double coarse) {
    const double gained = std::max(coarse - fine, 1e-3 * coarse);
    return gained > 0 ? kSplitCost * fine * coarse / gained : 0;
}

CosineIntegrand::CosineIntegrand(const Environment& environment, const CellSplitter& splitter,
                                 const Vec3f& normal, float tilt, float leastNoise)
    : environment_(environment),
      splitter_(splitter),
      normal_(normal),
      tilt_(tilt),
      leastNoise_(std::max(splitter.leastNoise(), leastNoise)) {}

bool CosineIntegrand::look(const CellBlock& block, Scratch& scratch) const {
    if (!isAbove(block.light, normal_, tilt_)) return false;
    lightCells(block.light, normal_, environment_.luminanceWeights(), scratch.sky);
    return true;
}

void CosineIntegrand::split(const CellBlock& block, const CellVisibility& v,
                            const PooledVisibility& pooled, Scratch& scratch,
                            Splits& splits) const {
    splitter_.mark(pooled, block.tier, block.number, scratch.sky, v.c, leastNoise_, splits);
}

void CosineIntegrand::describe(const CellBlock& block, const Splits& splits, Scratch& scratch,
                               RegionEvidence& e) const {
    CellLight& sky = scratch.sky;
    if (splits.any)
        for (int i = 0; i < kBlockCells; ++i) sky.light[i] = splits.marks[i] ? 0.0f : sky.light[i];
    const Rgb& weights = environment_.luminanceWeights();
    for (int i = 0; i < kBlockCells; ++i) {
        const float irradiance = weights.x * sky.irradiance[0][i] +
                                 weights.y * sky.irradiance[1][i] +
                                 weights.z * sky.irradiance[2][i];
        e.reflected[i] = sky.light[i] > 0 ? irradiance : 0.0f;
    }
    if (tilt_ > 0) tiltLight(block.light, normal_, tilt_, splits, sky);
    const CellMoments& m = block.light;
    const Vec3f& n = normal_;
    e.countedBrightness = false;
    for (int i = 0; i < kBlockCells; ++i) {
        const float height = n.x * m.axis[0][i] + n.y * m.axis[1][i] + n.z * m.axis[2][i];
        e.luminance[i] = sky.light[i];
        e.moment[i] = sky.cosineMoment[i];
        e.fitMoment[i] = sky.fitMoment[i];
        e.light[i] = e.sure[i] = sky.light[i] * std::sqrt(sky.cosineMoment[i]);
        e.fitted[i] = 1;
        e.exact[i] = height >= m.sinRadius[i] ? 1.0f : 0.0f;
    }
}

/// As lightCells() integrates it.
void CosineIntegrand::fit(const CellBlock& block, const Scratch&, Fit& out) const {
    const CellMoments& m = block.light;
    const Vec3f& n = normal_;
    alignas(64) float cut[kBlockCells];
    for (int i = 0; i < kBlockCells; ++i) {
        const float height = n.x * m.axis[0][i] + n.y * m.axis[1][i] + n.z * m.axis[2][i];
        const float radius = m.sinRadius[i] > 1e-9f ? m.sinRadius[i] : 1e-9f;
        cut[i] = std::abs(height) < m.sinRadius[i] ? 1.0f : 0.0f;
        const HorizonFit horizon(cut[i] > 0 ? height : 0.0f, radius);
        const float above = height >= m.sinRadius[i] ? 1.0f : 0.0f;
        out.constant[i] = cut[i] * horizon.constant;
        out.linear[i] = cut[i] > 0 ? horizon.linear : above;
        out.square[i] = cut[i] * horizon.square;
    }
    out.cut = maximumOf(cut) > 0;
}

CosineIntegral::CosineIntegral(const Environment& environment,
                               const FittedRegions<CosineIntegrand>& fitted,
                               const RegionShares& shares) {
    for (std::size_t g = 0; g < fitted.fits.size(); ++g) {
        const RegionGroup& group = fitted.regions.groups[g];
        addGroup(environment.cells(group.level, group.firstCell / kBlockCells), fitted.fits[g],
                 shares.groups[g]);
    }
}

void CosineIntegral::addGroup(const CellMoments& m, const CosineIntegrand::Fit& fit,
                              const GroupShares& shares) {
    alignas(64) float c[kBlockCells], weight[kBlockCells];
    for (int i = 0; i < kBlockCells; ++i) {
        c[i] = shares.weight[i] > 0 ? shares.visibility[i] : 0.0f;
        weight[i] = c[i] * fit.linear[i];
    }
    if (maximumOf(c) == 0) return;
    for (int k = 0; k < 3; ++k)
        for (int x = 0; x < 3; ++x) linear_[k][x] += dot(weight, m.firstMoment[k][x]);
    if (!fit.cut) return;
    for (int i = 0; i < kBlockCells; ++i) weight[i] = c[i] * fit.constant[i];
    // The trace of the second moment is the light itself.
    for (int k = 0; k < 3; ++k)
        for (int x = 0; x < 3; ++x) constant_[k] += dot(weight, m.second[k][x]);
    for (int i = 0; i < kBlockCells; ++i) weight[i] = c[i] * fit.square[i];
    for (int k = 0; k < 3; ++k)
        for (int x = 0; x < 6; ++x) square_[k][x] += dot(weight, m.second[k][x]);
}

Rgb CosineIntegral::at(const Vec3f& normal) const {
    const auto x = static_cast<double>(normal.x), y = static_cast<double>(normal.y),
               z = static_cast<double>(normal.z);
    Rgb sum;
    for (int k = 0; k < 3; ++k) {
        const double* b = linear_[k];
        const double* d = square_[k];
        sum[k] = static_cast<float>(constant_[k] + b[0] * x + b[1] * y + b[2] * z + d[0] * x * x +
                                    d[1] * y * y + d[2] * z * z +
                                    2 * (d[3] * x * y + d[4] * x * z + d[5] * y * z));
    }
    return sum;
}

}  // namespace shadowcache
