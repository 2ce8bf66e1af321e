#pragma once

#include <span>
#include <vector>

#include "common/base/stopwatch.h"
#include "render/cached/cluster_sampler.h"
#include "render/cached/neighbor_reuse.h"
#include "render/cached/point_clusters.h"
#include "render/cached/sample_tracer.h"
#include "render/regions/region_builder.h"

namespace shadowcache {

/// What lighting a batch cluster by cluster takes; its memory is reused from batch to batch. One
/// object a thread.
template <Integrand I>
struct LightTools {
    LightTools(const Environment& environment, const DirectionTiers& tiers,
               const PlanRules& rules = {})
        : builder(environment, tiers),
          planner(rules),
          distribution(environment),
          sampler(environment),
          reuse(environment) {}

    PointClusters clusters;
    RegionBuilder<I> builder;
    SamplingPlanner planner;
    std::vector<double> wanted;       ///< samples of a cluster's points
    std::vector<SampleCount> counts;  ///< the same, rounded
    RegionDistribution distribution;  ///< of a cluster
    ClusterSampler sampler;
    NeighborReuse<I> reuse;
    SampleTracer tracer;
};

/// All that is decided of a cluster before any ray.
template <Integrand I>
struct PlannedCluster {
    std::span<const std::uint32_t> members;  ///< numbers of its points in the batch
    std::span<const SampleCount> counts;     ///< of their samples of the regions
    const FittedRegions<I>& fitted;
    const SamplingPlan& plan;
    const RegionDistribution& distribution;  ///< of the plan
};

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
void traceSample(const SamplingPlan& plan, const DrawnSample& s, bool above, const Value& value,
                 const Value& standIn, SampleTracer::Run& run) {
    const Rgb light = s.light.radiance * s.weight;
    const Rgb occluded = light * -standIn;
    if (!above) return run.add(s.point, occluded);
    const float reuse = s.place.found() ? plan.groups[s.place.group].reuse[s.place.lane] : 0.0f;
    const Rgb visible = light * (value - standIn);
    if (reuse == 0) return run.trace(s.point, s.light.direction, visible, occluded);
    // Where the sky is predicted, c is 1: a fit's error counts whatever the ray finds, and an
    // occluder takes away the integrand itself.
    if (!I::kFitIsExact && reuse < 0) run.add(s.point, visible);
    run.traceForReuse({s.light.direction, s.light.radiance, s.light.cell, s.lightDensity, s.point},
                      reuse > 0);
}

/// Lights the points of a batch by the cache: the core loop, for the irradiance and for lobes
/// alike. `light` is a CosineLight or a LobeLight. [docs/estimator.md]
template <class Light>
void lightBatch(const EstimatorContext& context, const PointBatch& batch, Light& light,
                LightTools<typename Light::Integrand>& tools, Workspace& watch,
                std::span<Estimate> estimates) {
    Stopwatch time;
    tools.clusters.build(batch.points, context.cache->header().spacing, batch.cameraRays,
                         batch.samples);
    auto reuse = tools.reuse.begin(batch, tools.clusters, light.points());
    for (const PointCluster& cluster : tools.clusters.clusters()) {
        const std::span<const std::uint32_t> members = tools.clusters.membersOf(cluster);
        const auto& fitted = light.regionsOf(cluster, members);
        const SamplingPlan& plan = light.plan(fitted.regions, members);
        light.addIntegrals(fitted, plan, members, estimates);
        tools.distribution.assign(fitted.regions, plan);
        reuse.addCluster(fitted.regions, plan, tools.distribution, members, tools.counts,
                         light.heavyFrom());
        const std::span<const ClusterSample> samples =
            tools.sampler.draw(batch, members, tools.counts, tools.distribution, context.sequence);
        watch.setupNanoseconds += time.sinceLast();
        SampleTracer::Run run =
            tools.tracer.begin(context, batch, members, reuse.found(), estimates);
        light.trace({members, tools.counts, fitted, plan, tools.distribution}, samples, run);
        run.finish();
        watch.traceNanoseconds += time.sinceLast();
    }
    reuse.finish(context.scene, estimates);
    watch.traceNanoseconds += time.sinceLast();
}

}  // namespace shadowcache
