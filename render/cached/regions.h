#pragma once

#include <cstdint>
#include <vector>

#include "common/base/tuned.h"
#include "common/light/environment.h"
#include "common/predict/cell_splits.h"
#include "common/predict/pooled_visibility.h"
#include "render/cached/calibration.h"

namespace shadowcache {

/// Sixteen consecutive cells of one level as regions to draw samples from. Cells that are no
/// regions (below the horizon of every point, dark, or split further) have no deviation.
struct alignas(64) RegionGroup {
    std::uint32_t firstCell;
    int level;
    /// Light of a region as far as nothing hides it, in the scale of a sample's contribution.
    alignas(64) float light[kBlockCells];
    /// Predicted standard deviation of a sample from the region alone.
    alignas(64) float deviation[kBlockCells];
    /// c: the visibility that the counts predict, corrected where the pilot found them wrong.
    alignas(64) float visibility[kBlockCells];
    /// Probability that light of the region is seen, as the counts and the hierarchy have it, and
    /// the same calibrated by the pilot.
    alignas(64) float posterior[kBlockCells];
    alignas(64) float calibrated[kBlockCells];
    /// 1 where the region lies wholly above the horizon, else 0.
    alignas(64) float above[kBlockCells];
    /// The control variate's cosine at x = n . w: constant + linear x + square x^2.
    alignas(64) float constant[kBlockCells];
    alignas(64) float linear[kBlockCells];
    alignas(64) float square[kBlockCells];
    bool cut;  ///< some region lies across the horizon
};

/// The hemisphere above a cluster of points, in regions. [docs/estimator.md]
struct Regions {
    std::vector<RegionGroup> groups;
    double lightSum = 0;            ///< of all regions
    double deviationSum = 0;        ///< about the deviation of one sample drawn in proportion to it
    double predictedLuminance = 0;  ///< sum over the regions of c (n . V), its luminance
    double surelyVisible = 0;       ///< light of the regions that are almost surely visible
};

/// A region of more predicted visibility counts as visible until a ray says otherwise. High,
/// because noise in a dark place that was predicted bright is seen, and the reverse is not.
inline SHADOWCACHE_TUNED(float, kMostlyVisible, 0.75f);

/// Noise of a cell, times the samples of its cluster, below which splitting it costs more time than
/// it saves. With `fine` the deviation of a sample in a frame's mean where all cells are split that
/// can be, and `coarse` where none is, a split of a cell of noise x lowers the deviation by about
/// x (coarse - fine) / coarse; where it hardly does, as among leaves, few pay.
///
/// @param fine, coarse  at least 0 [radiance sr], as the result
double splitNoise(double fine, double coarse);

struct ParentVisibility;

/// Makes regions of pooled counts. Its buffers are used again from call to call.
class RegionBuilder {
public:
    RegionBuilder(const Environment& environment, const DirectionTiers& tiers)
        : environment_(environment), tiers_(tiers), splitter_(environment, tiers) {}

    /// Regions for points whose normals are within the angle of sine `tilt` of `normal`: every
    /// direction above the horizon of one of them lies in a region.
    ///
    /// @param leastNoise  of a cell: below it the cell stays whole, as below the splitter's own
    ///                    [radiance sr]
    /// @return valid until the next call
    const Regions& build(const PooledVisibility& pooled, const Vec3f& normal, float tilt,
                         const Calibration& calibration, float leastNoise);

private:
    struct Task;
    void addBlock(const Task& task, int tier, std::uint32_t block, const PooledBlock* counts,
                  const ParentVisibility& parent);

    const Environment& environment_;
    DirectionTiers tiers_;
    CellSplitter splitter_;
    Regions regions_;
};

}  // namespace shadowcache
