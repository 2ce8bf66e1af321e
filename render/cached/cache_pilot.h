#pragma once

#include <cstdint>
#include <vector>

#include "render/cached/calibration.h"
#include "render/cached/regions.h"
#include "render/estimators/estimator.h"

namespace shadowcache {

/// Compares the counts at one place after another with a few rays, half of them where the counts
/// are unsure and half where the light is. Arrays are reused from place to place.
class PilotRays {
public:
    /// Adds to `found` rays from `point`, whose regions are given, beside what the counts
    /// predicted.
    ///
    /// @return number of rays
    std::uint64_t trace(const EstimatorContext& context, const ShadingPoint& point,
                        const Regions& regions, LightSamples& samples, Calibration& found);

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
