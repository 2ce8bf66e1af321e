#pragma once

#include <vector>

#include "render/cached/region_weights.h"
#include "render/cached/reliability.h"
#include "render/estimators/estimator.h"

namespace shadowcache {

/// Compares the counts at one place after another with a few rays, half of them where the counts
/// are unsure and half where the light is. Arrays are reused from place to place.
class CacheSurvey {
public:
    /// Notes in `found` what rays from `point`, whose regions are in `weights`, say of the counts.
    ///
    /// @return number of rays
    std::uint64_t look(const Scene& scene, const Environment& environment,
                       const ShadingPoint& point, const RegionWeights& weights,
                       LightSamples& samples, Reliability& found);

private:
    struct Region {
        int level;
        std::uint32_t cell;
        float posterior;
        float weight[2];  ///< predicted standard deviation of a sample; light
    };

    void draw(const Environment& environment, const ShadingPoint& point, int k, double sum,
              LightSamples& samples);

    std::vector<Region> regions_;
    std::vector<float> posteriors_;  ///< of the region of each ray
};

}  // namespace shadowcache
