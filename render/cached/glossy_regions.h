#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/surface/surface.h"
#include "render/cached/quadratic_cells.h"
#include "render/cached/sampling_plan.h"

namespace shadowcache {

struct ParentVisibility;

/// The regions around a cluster of glossy points, for the lobe of its central one: light and
/// deviations of Regions are what the lobe reflects, and the lobe itself is fitted in each region
/// by a quadratic, whose integral against the light is exact. [docs/estimator.md]
struct GlossyRegions {
    Regions regions;
    std::vector<QuadraticFit> fits;  ///< as Regions::groups
    /// Predicted visibility, as Regions::groups, where fits are of no use as well.
    std::vector<std::array<float, kBlockCells>> predicted;
};

/// Makes them of pooled counts. Its buffers are used again from call to call.
class GlossyRegionBuilder {
public:
    GlossyRegionBuilder(const Environment& environment, const DirectionTiers& tiers)
        : environment_(environment),
          tiers_(tiers),
          leastNoise_(CellSplitter(environment, tiers).leastNoise() / static_cast<float>(kPi)) {}

    /// @param misfit  mean square of what the points' lobes differ from this one, relative to it; 1
    ///                or more: the quadratics are of no use
    /// @return valid until the next call
    const GlossyRegions& build(const QuadraticCells& cells, const PooledVisibility& pooled,
                               const GlossyLobe& lobe, float misfit,
                               const Calibration& calibration);

private:
    struct Task;
    void addBlock(const Task& task, int tier, std::uint32_t block, const PooledBlock* counts,
                  const ParentVisibility& parent);

    const Environment& environment_;
    DirectionTiers tiers_;
    float leastNoise_;
    GlossyRegions result_;
};

/// What the control variate reflects of the light, for the central lobe: the sum over the regions
/// of c times the integral of L q.
Rgb integralOf(const QuadraticCells& cells, const GlossyRegions& glossy, const SamplingPlan& plan);

/// What the cache predicts that the lobe reflects, without a ray: the same with the visibility that
/// is predicted of all regions.
Rgb predictionOf(const QuadraticCells& cells, const GlossyRegions& glossy);

}  // namespace shadowcache
