#include "render/regions/regions.h"

#include <cmath>

#include "common/predict/lanes.h"
#include "render/regions/cell_visibility.h"

namespace shadowcache {

void Regions::add(const RegionEvidence& e, const Calibration& calibration) {
    RegionGroup& group = groups.emplace_back();
    group.firstCell = e.firstCell;
    group.level = e.level;
    alignas(64) float slope[kBlockCells], offset[kBlockCells];
    alignas(64) float predicted[kBlockCells], sure[kBlockCells];
    calibration.apply<kBlockCells>(e.posterior, group.calibrated, slope, offset);
    for (int i = 0; i < kBlockCells; ++i) {
        const float cached = slope[i] * e.counted[i] + offset[i];
        const float c = e.fitted[i] > 0 ? cached : 0.0f;
        group.light[i] = e.light[i];
        group.exact[i] = e.exact[i];
        group.cached[i] = cached;
        group.visibility[i] = c;
        group.deviation[i] =
            e.luminance[i] *
            std::sqrt(residualMoment(group.calibrated[i], c, e.moment[i], e.fitMoment[i]));
        const float seen = e.countedBrightness ? e.counted[i] : cached;
        predicted[i] = seen * e.reflected[i];
        sure[i] = seen > kMostlyVisible ? e.sure[i] : 0.0f;
    }
    deviationSum += static_cast<double>(sumOf(group.deviation));
    lightSum += static_cast<double>(sumOf(group.light));
    predictedLuminance += static_cast<double>(sumOf(predicted));
    surelyVisible += static_cast<double>(sumOf(sure));
}

}  // namespace shadowcache
