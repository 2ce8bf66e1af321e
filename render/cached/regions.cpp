#include "render/cached/regions.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/tuned.h"
#include "common/predict/cell_light.h"
#include "common/predict/horizon.h"
#include "common/predict/lanes.h"
#include "render/cached/cell_visibility.h"

namespace shadowcache {

/// What all blocks of one place share.
struct RegionBuilder::Task {
    const PooledVisibility& pooled;
    const Calibration& calibration;
    Vec3f normal;
    float tilt;
    float leastNoise;
};

namespace {

/// Mean square, over the tilts of a cluster's normals, of what they change of a cosine, as a share
/// of the widest tilt's square.
SHADOWCACHE_TUNED(float, kTiltMoment, 0.1f);

/// Least height over the horizon at which the share of a tilt in the cosine is evaluated.
SHADOWCACHE_TUNED(float, kLeastTiltHeight, 0.05f);

/// Half of the time that the sixteen regions of a split cell take, in those of a sample: a
/// deviation lower by a part p saves as much as 2 p of the samples.
SHADOWCACHE_TUNED(double, kSplitCost, 0.1);

/// The stand-in of the cosine in each region of the group, as lightCells() integrates it.
void fitCosines(const CellMoments& m, const Vec3f& n, RegionGroup& group) {
    alignas(64) float cut[kBlockCells];
    for (int i = 0; i < kBlockCells; ++i) {
        const float height = n.x * m.axis[0][i] + n.y * m.axis[1][i] + n.z * m.axis[2][i];
        const float radius = m.sinRadius[i] > 1e-9f ? m.sinRadius[i] : 1e-9f;
        cut[i] = std::abs(height) < m.sinRadius[i] ? 1.0f : 0.0f;
        const HorizonFit fit(cut[i] > 0 ? height : 0.0f, radius);
        group.above[i] = height >= m.sinRadius[i] ? 1.0f : 0.0f;
        group.constant[i] = cut[i] * fit.constant;
        group.linear[i] = cut[i] > 0 ? fit.linear : group.above[i];
        group.square[i] = cut[i] * fit.square;
    }
    group.cut = maximumOf(cut) > 0;
}

/// Widens what is known of a block at one normal to all normals within the angle of sine `tilt`:
/// cells below the horizon of the one may be above another's, and cosines differ.
void tiltLight(const CellMoments& m, const Vec3f& n, float tilt, const Splits& split,
               CellLight& sky) {
    for (int i = 0; i < kBlockCells; ++i) {
        if (split.any && split.marks[i]) continue;
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

}  // namespace

double splitNoise(double fine, double coarse) {
    const double gained = std::max(coarse - fine, 1e-3 * coarse);
    return gained > 0 ? kSplitCost * fine * coarse / gained : 0;
}

const Regions& RegionBuilder::build(const PooledVisibility& pooled, const Vec3f& normal, float tilt,
                                    const Calibration& calibration, float leastNoise) {
    std::vector<RegionGroup> groups = std::move(regions_.groups);
    groups.clear();
    regions_ = {std::move(groups)};
    const ParentVisibility sphere = sphereVisibility(pooled);
    const Task task{pooled, calibration, normal, tilt,
                    std::max(splitter_.leastNoise(), leastNoise)};
    for (std::uint32_t b = 0; b < pooled.baseBlocks(); ++b)
        addBlock(task, 0, b, &pooled.base(b), sphere);
    return regions_;
}

void RegionBuilder::addBlock(const Task& task, int tier, std::uint32_t block,
                             const PooledBlock* counts, const ParentVisibility& parent) {
    const int level = tiers_.baseLevel() + 2 * tier;
    const CellMoments& m = environment_.cells(level, block);
    if (!isAbove(m, task.normal, task.tilt)) return;
    CellLight sky;
    lightCells(m, task.normal, environment_.luminanceWeights(), sky);
    CellVisibility v;
    estimateVisibility(counts, parent, v);
    Splits split;
    splitter_.mark(task.pooled, tier, block, sky, v.c, task.leastNoise, split);
    if (split.any)
        for (int i = 0; i < kBlockCells; ++i) sky.light[i] = split.marks[i] ? 0.0f : sky.light[i];
    alignas(64) float cosine[kBlockCells];  // mean over the region, in light
    for (int i = 0; i < kBlockCells; ++i) cosine[i] = sky.light[i];
    if (task.tilt > 0) tiltLight(m, task.normal, task.tilt, split, sky);

    RegionGroup& group = regions_.groups.emplace_back();
    group.firstCell = block * kBlockCells;
    group.level = level;
    alignas(64) float correction[kBlockCells], predicted[kBlockCells], sure[kBlockCells];
    task.calibration.apply<kBlockCells>(v.posterior, group.calibrated, correction);
    const Rgb& weights = environment_.luminanceWeights();
    for (int i = 0; i < kBlockCells; ++i) {
        const float c = corrected(v.c[i], correction[i]);
        group.visibility[i] = c;
        group.posterior[i] = v.posterior[i];
        group.light[i] = sky.light[i] * std::sqrt(sky.cosineMoment[i]);
        group.deviation[i] =
            sky.light[i] * std::sqrt(residualMoment(group.calibrated[i], c, sky.cosineMoment[i],
                                                    sky.fitMoment[i]));
        const float share = cosine[i] > 0 ? c : 0.0f;
        predicted[i] =
            share * (weights.x * sky.irradiance[0][i] + weights.y * sky.irradiance[1][i] +
                     weights.z * sky.irradiance[2][i]);
        sure[i] = c > kMostlyVisible ? group.light[i] : 0.0f;
    }
    const float sum = sumOf(group.deviation);
    if (sum > 0) {
        fitCosines(m, task.normal, group);
        regions_.deviationSum += static_cast<double>(sum);
        regions_.lightSum += static_cast<double>(sumOf(group.light));
        regions_.predictedLuminance += static_cast<double>(sumOf(predicted));
        regions_.surelyVisible += static_cast<double>(sumOf(sure));
    } else {
        regions_.groups.pop_back();
    }
    split.forEach([&](int i) {
        const std::uint32_t cell = block * kBlockCells + static_cast<std::uint32_t>(i);
        addBlock(task, tier + 1, cell, task.pooled.children(tier, cell), {v.c[i], v.posterior[i]});
    });
}

}  // namespace shadowcache
