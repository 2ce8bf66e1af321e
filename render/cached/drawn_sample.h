#pragma once

#include "render/cached/sample_tracer.h"
#include "render/regions/region_builder.h"
#include "render/regions/region_distribution.h"

namespace shadowcache {

/// A sample of a point, whatever drew it.
struct DrawnSample {
    std::uint32_t point;
    RegionPlace place;  ///< may be none
    EnvironmentSample light;
    double lightDensity;  ///< density in proportion to the light, along the direction [radiance]
    float weight;         ///< 1 / (density of all samples of the point there) [sr]
};

/// Traces a sample, or hands it on to be reused.
///
/// @param above    whether the direction is above the point's horizon
/// @param value    of the point's integrand
/// @param standIn  c times what stands in for it
template <Integrand I, class Value>
void traceSample(const RegionShares& shares, const DrawnSample& s, bool above, const Value& value,
                 const Value& standIn, SampleTracer::Run& run) {
    const Rgb light = s.light.radiance * s.weight;
    const Rgb occluded = light * -standIn;
    if (!above) return run.add(s.point, occluded);
    const float reuse = s.place.found() ? shares.groups[s.place.group].reuse[s.place.lane] : 0.0f;
    const Rgb visible = light * (value - standIn);
    if (reuse == 0) return run.trace(s.point, s.light.direction, visible, occluded);
    // Where the sky is predicted, c is 1: a fit's error counts whatever the ray finds, and an
    // occluder takes away the integrand itself.
    if (!I::kFitIsExact && reuse < 0) run.add(s.point, visible);
    run.traceForReuse({s.light.direction, s.light.radiance, s.light.cell, s.lightDensity, s.point},
                      reuse > 0, light * value);
}

}  // namespace shadowcache
