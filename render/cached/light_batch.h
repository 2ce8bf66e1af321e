#pragma once

#include <span>
#include <vector>

#include "common/base/stopwatch.h"
#include "render/cached/cache_plan.h"
#include "render/cached/cluster_offers.h"
#include "render/cached/cluster_sampler.h"
#include "render/cached/neighbor_reuse.h"
#include "render/cached/place_lookup.h"
#include "render/cached/point_clusters.h"
#include "render/cached/sample_tracer.h"
#include "render/regions/region_builder.h"

namespace shadowcache {

/// A batch of points, and what lights them. All outlive its lighting.
struct CachedBatch {
    const EstimatorContext& context;
    const CachePlan& plan;  ///< of the frame
    const PointBatch& points;
    PlaceLookup& lookup;
    Workspace& workspace;  ///< receives times, counts and watched samples
};

/// Memory in which a thread lights clusters; used again from batch to batch.
template <Integrand I>
struct LightTools {
    LightTools(const Environment& environment, const DirectionTiers& tiers,
               const ShareRules& rules = {})
        : builder(environment, tiers),
          sharer(rules),
          distribution(environment),
          sampler(environment),
          offers(environment),
          reuse(environment) {}

    PointClusters clusters;
    RegionBuilder<I> builder;
    std::vector<double> wanted;       ///< samples of a cluster's points
    std::vector<SampleCount> counts;  ///< the same, rounded
    RegionSharer sharer;
    RegionDistribution distribution;
    ClusterSampler sampler;
    SampleTracer tracer;
    ClusterOffers offers;
    std::vector<Misprediction> mispredictions;
    NeighborReuse<I> reuse;
};

/// All that is decided of a cluster before any ray.
template <class Light>
struct SampledCluster {
    std::span<const std::uint32_t> members;  ///< numbers of its points in the batch
    const typename Light::Model& model;
    const ClusterCounts& counts;
    const RegionShares& shares;
    const RegionDistribution& distribution;  ///< of the shares
};

/// Lights the points of a batch by the cache, for the irradiance and for lobes alike: the core
/// loop. `light` is a CosineLight or a LobeLight. [docs/estimator.md]
///
/// @param estimates  of the points; initially 0
template <class Light>
void lightBatch(const CachedBatch& batch, Light& light,
                LightTools<typename Light::Integrand>& tools, std::span<Estimate> estimates) {
    Stopwatch time;
    const PointBatch& points = batch.points;
    tools.offers.begin(points.points.size());
    tools.mispredictions.clear();
    for (const PointCluster& cluster :
         tools.clusters.build(points.points, batch.context.cache->header().spacing,
                              points.cameraRays, points.samples)) {
        const auto model = light.modelOf(cluster);
        const Regions& regions = model.fitted.regions;
        const ClusterCounts counts = light.countSamples(cluster, model);
        const RegionShares& shares = light.shareSamples(regions, counts);
        const auto& distribution = tools.distribution.assign(regions, shares);
        const SampledCluster<Light> sampled{cluster.members, model, counts, shares, distribution};

        light.integrate(sampled, estimates);
        tools.offers.add(cluster.members, regions, shares, distribution, counts);
        const std::span<const ClusterSample> samples = tools.sampler.draw(
            points, cluster.members, counts.ofRegions, distribution, batch.context.sequence);
        batch.workspace.setupNanoseconds += time.sinceLast();

        SampleTracer::Run run = tools.tracer.begin(batch.context, points, cluster.members,
                                                   tools.mispredictions, estimates);
        light.trace(sampled, samples, run);
        run.finish();
        batch.workspace.traceNanoseconds += time.sinceLast();
    }
    tools.reuse.share(tools.mispredictions, tools.offers,
                      {batch.context.scene, points, light.points(), estimates});
    batch.workspace.traceNanoseconds += time.sinceLast();
}

}  // namespace shadowcache
