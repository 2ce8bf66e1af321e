#include "render/cached/cluster_lighting.h"

namespace shadowcache {

void traceCluster(const EstimatorContext& context, const PointBatch& batch,
                  const FittedRegions<CosineIntegrand>& fitted, const SamplingPlan& plan,
                  std::span<const ClusterSample> samples, SampleTracer::Run& run) {
    const Environment& environment = context.environment;
    for (const ClusterSample& sample : samples) {
        const RegionGroup& region = fitted.regions.groups[sample.place.group];
        const PlannedGroup& planned = plan.groups[sample.place.group];
        const int i = sample.place.lane;
        const EnvironmentSample s = sample.finish(environment);
        const float x = s.direction.dot(batch.points[sample.point].normal);
        const Rgb light = s.radiance * (sample.share / s.density);
        const float predicted = planned.visibility[i] * fitted.fits[sample.place.group].value(i, x);
        if (x <= 0) {  // no ray: below the point's horizon nothing is seen
            run.add(sample.point, light * -predicted);
        } else if (planned.reuse[i] != 0) {
            const std::uint32_t cell = region.firstCell + static_cast<std::uint32_t>(i);
            const double lightDensity =
                static_cast<double>(s.density) * environment.luminanceIntegral(region.level, cell);
            run.traceForReuse({s.direction, s.radiance, s.cell, lightDensity, sample.point},
                              planned.reuse[i] > 0);
        } else {
            run.trace(sample.point, s.direction, light * (x - predicted), light * -predicted);
        }
    }
    run.finish();
}

}  // namespace shadowcache
