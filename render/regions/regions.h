#pragma once

#include <cstdint>
#include <vector>

#include "common/base/tuned.h"
#include "common/cache/cache_header.h"
#include "render/regions/calibration.h"

namespace shadowcache {

// How fine regions may be is the cache's: BakeOptions::level (bake/core/options.h), for shots
// chosen by bake/shot/shot_spacing.cpp.

/// What an integrand and the counts say of sixteen consecutive cells of one level, before a pilot
/// calibrates it. Cells that are no regions (below the horizon of every point, dark, or split
/// further) have no light.
struct alignas(64) RegionEvidence {
    std::uint32_t firstCell;
    int level;
    /// Whether the place's brightness follows the counts as they are, before they are corrected.
    bool countedBrightness;
    /// Luminance that the integrand's moments are to be multiplied with. [radiance sr]
    alignas(64) float luminance[kBlockCells];
    /// Means over the region of the squares of the integrand and of the fit that stands in for it.
    alignas(64) float moment[kBlockCells];
    alignas(64) float fitMoment[kBlockCells];
    /// RegionGroup::light and RegionGroup::exact.
    alignas(64) float light[kBlockCells];
    alignas(64) float exact[kBlockCells];
    /// 1 where the fit is of use to the control variate, else 0.
    alignas(64) float fitted[kBlockCells];
    /// Luminance that the integrand makes of the light if all of it is seen, on average over the
    /// points, and the part of a point that counts as almost surely seen where the light is.
    alignas(64) float reflected[kBlockCells];
    alignas(64) float sure[kBlockCells];
    /// Visibility and probability that light is seen, as the counts and the hierarchy have them.
    alignas(64) float counted[kBlockCells];
    alignas(64) float posterior[kBlockCells];
};

/// Sixteen consecutive cells of one level as regions to draw samples from. Cells that are no
/// regions have no light and no deviation.
struct alignas(64) RegionGroup {
    std::uint32_t firstCell;
    int level;
    /// Light of a region as far as nothing hides it, in the scale of a sample's contribution.
    alignas(64) float light[kBlockCells];
    /// Predicted standard deviation of a sample from the region alone.
    alignas(64) float deviation[kBlockCells];
    /// The visibility that the counts predict, corrected where the pilot found them wrong.
    alignas(64) float cached[kBlockCells];
    /// c, the control variate's visibility: the same, 0 where no fit is of use.
    alignas(64) float visibility[kBlockCells];
    /// Probability that light of the region is seen, calibrated by the pilot.
    alignas(64) float calibrated[kBlockCells];
    /// 1 where the fit is the integrand itself, so that c may be taken for 1, else 0.
    alignas(64) float exact[kBlockCells];
};

/// The hemisphere above a cluster of points, in regions. [docs/estimator.md]
struct Regions {
    std::vector<RegionGroup> groups;
    double lightSum = 0;            ///< of all regions
    double deviationSum = 0;        ///< about the deviation of one sample drawn in proportion to it
    double predictedLuminance = 0;  ///< sum over the regions of what is reflected, as predicted
    double surelyVisible = 0;       ///< light of the regions that are almost surely visible

    void clear() {
        groups.clear();
        lightSum = deviationSum = predictedLuminance = surelyVisible = 0;
    }
    /// Adds a group: the evidence, calibrated.
    void add(const RegionEvidence& evidence, const Calibration& calibration);
};

/// A region of more predicted visibility counts as visible until a ray says otherwise. High,
/// because noise in a dark place that was predicted bright is seen, and the reverse is not.
inline SHADOWCACHE_TUNED(float, kMostlyVisible, 0.75f);

}  // namespace shadowcache
