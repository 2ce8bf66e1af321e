#include "render/cached/glossy_cache.h"

#include "common/base/tuned.h"
#include "common/random/salts.h"

namespace shadowcache {

namespace {

/// Samples of the regions in proportion to the light that the central lobe reflects, for each that
/// follows the counts: more than for the irradiance, as the other lobes differ from the central.
SHADOWCACHE_TUNED(double, kGlossyDefensiveShare, 0.8);

/// Part of what a point reflects from which on a sample is reused: less than of the irradiance, as
/// fewer regions make up for one that is mispredicted.
SHADOWCACHE_TUNED(double, kGlossyHeavy, 0.02);

/// Predicted visibility from which on reuse expects the sky: almost surely, as a lobe that is
/// wrongly predicted bright is all that a dark point has.
SHADOWCACHE_TUNED(float, kGlossyMostlyVisible, 0.97f);

/// Least width of a lobe that fits over the finest cells follow; regions are chosen for narrower
/// ones as if they were so wide.
SHADOWCACHE_TUNED(float, kLeastFittedAlpha, 0.03f);

}  // namespace

PlanRules glossyRules() {
    return {kGlossyDefensiveShare, 0, kGlossyMostlyVisible};
}

GlossyWorkspace::GlossyWorkspace(const Environment& environment, const DirectionTiers& tiers)
    : builder(environment, tiers),
      leastNoise(CellSplitter(environment, tiers).leastNoise()),
      planner(glossyRules()) {}

/// A batch under way.
struct GlossyCache::Batch {
    const PointBatch& batch;  ///< with seeds of their own
    std::span<const GlossyPoint> points;
    const GlossyFrame& frame;
    PlaceLookup& lookup;
    ClusterTools& tools;
    GlossyWorkspace& w;
};

const GlossyTables& GlossyCache::tables() const {
    std::call_once(tablesMade_, [&] {
        tables_.emplace(context_.environment, context_.cache->header().tiers());
    });
    return *tables_;
}

void GlossyCache::estimate(const PointBatch& batch, std::span<const GlossyPoint> points,
                           const GlossyFrame& frame, PlaceLookup& lookup, ClusterTools& tools,
                           GlossyWorkspace& own, Workspace& watch,
                           std::span<GlossEstimate> estimates) const {
    if (context_.environment.luminanceIntegral() <= 0) return;
    Stopwatch time;
    own.points.clear();
    for (const GlossyPoint& glossy : points) {
        ShadingPoint& point = own.points.emplace_back(glossy.point);
        point.seed = hashWords(point.seed, RenderSalt::glossCluster);
    }
    own.estimates.assign(points.size(), {});
    PointBatch reseeded = batch;
    reseeded.points = own.points;
    tools.clusters.build(reseeded.points, context_.cache->header().spacing, batch.cameraRays,
                         batch.samples);
    const Batch task{reseeded, points, frame, lookup, tools, own};
    NeighborReuse::Batch reuse = tools.reuse.begin(reseeded, tools.clusters, points);
    for (const PointCluster& cluster : tools.clusters.clusters()) {
        if (batch.samples == 0) {
            predict(task, cluster);
            continue;
        }
        const GlossyCluster prepared = prepare(task, cluster, reuse);
        const std::span<const ClusterSample> samples =
            tools.sampler.draw(reseeded, prepared.members, prepared.ofRegions,
                               prepared.distribution, context_.sequence);
        watch.setupNanoseconds += time.sinceLast();
        SampleTracer::Run run =
            tools.tracer.begin(context_, reseeded, prepared.members, reuse, own.estimates);
        own.lighting.trace(context_, tables(), reseeded, points, prepared, samples, run);
        watch.traceNanoseconds += time.sinceLast();
    }
    reuse.finish(context_.scene, own.estimates);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Estimate& e = own.estimates[i];
        estimates[i] = {e.irradiance, e.variance, e.rays + e.reused};
    }
    watch.traceNanoseconds += time.sinceLast();
}

const FittedRegions<LobeIntegrand>& GlossyCache::regionsOf(const Batch& batch,
                                                           const PointCluster& cluster,
                                                           bool fitted) const {
    GlossyWorkspace& w = batch.w;
    const GlossyLobe& central = batch.points[cluster.centre].lobe;
    batch.lookup.pool(context_.scene, batch.batch.points[cluster.centre], cluster.radius);
    const auto members = batch.tools.membersOf(cluster);
    const LobeMatch match(central);
    float misfit = 0;
    w.matches.clear();
    for (const std::uint32_t point : members) {
        w.matches.push_back(match.fit(batch.points[point].lobe));
        misfit += w.matches.back().misfit / static_cast<float>(members.size());
        if (!fitted) w.matches.back().factor = Rgb(0.0f);
    }
    return build(batch, central.widened(kLeastFittedAlpha), fitted ? misfit : 1.0f);
}

const FittedRegions<LobeIntegrand>& GlossyCache::build(const Batch& batch, const GlossyLobe& lobe,
                                                       float misfit) const {
    return batch.w.builder.build(
        LobeIntegrand(context_.environment, tables().cells, context_.cache->header().tiers(),
                      batch.w.leastNoise, lobe, misfit),
        batch.lookup.pooled(), batch.frame.calibration);
}

GlossyCluster GlossyCache::prepare(const Batch& batch, const PointCluster& cluster,
                                   NeighborReuse::Batch& reuse) const {
    GlossyWorkspace& w = batch.w;
    const GlossyLobe& central = batch.points[cluster.centre].lobe;
    const FittedRegions<LobeIntegrand>& glossy =
        regionsOf(batch, cluster, central.alpha() >= kLeastFittedAlpha);
    const auto members = batch.tools.membersOf(cluster);
    const double share = batch.batch.samples;
    const SamplingPlan& plan = w.planner.plan(
        glossy.regions, kJudgedSamples, {batch.frame.darkest, kUnsureShareUniform}, kGlossyHeavy);
    const Rgb integral = integralOf(tables().cells, glossy, plan);
    for (std::size_t k = 0; k < members.size(); ++k)
        w.estimates[members[k]].irradiance = integral * w.matches[k].factor;
    const double ofLobes = lobeShare(central);
    const ShadingPoint& first = batch.batch.points[members.front()];
    const auto offset = [&](RenderSalt salt) {
        return toUnit(hashWords(first.seed, salt, first.cameraRay));
    };
    const auto sharesOf = [&](double ofAll, RenderSalt salt, std::vector<PointShare>& buffer) {
        std::vector<double>& wanted = batch.tools.wanted;
        wanted.clear();
        for (const std::uint32_t member : members)
            wanted.push_back(share * ofAll * static_cast<double>(batch.batch.points[member].share));
        return sharePoints(wanted, offset(salt), buffer);
    };
    const std::span<const PointShare> shares =
        sharesOf(1 - ofLobes, RenderSalt::glossShare, batch.tools.shares);
    const std::span<const PointShare> lobeShares =
        sharesOf(ofLobes, RenderSalt::glossRounding, w.lobeShares);
    RegionDistribution& distribution = batch.tools.distribution;
    distribution.assign(glossy.regions, plan);
    reuse.addCluster(glossy.regions, plan, distribution, members, shares, {}, lobeShares);
    return {members, shares, lobeShares, glossy, plan, distribution, w.matches};
}

void GlossyCache::predict(const Batch& batch, const PointCluster& cluster) const {
    GlossyWorkspace& w = batch.w;
    const Rgb predicted = predictionOf(tables().cells, regionsOf(batch, cluster, true));
    const auto members = batch.tools.membersOf(cluster);
    for (std::size_t k = 0; k < members.size(); ++k) {
        Rgb& estimate = w.estimates[members[k]].irradiance;
        estimate = predicted * w.matches[k].factor;
        if (w.matches[k].factor != Rgb(0.0f)) continue;
        const GlossyLobe lobe = batch.points[members[k]].lobe.widened(kLeastFittedAlpha);
        estimate = predictionOf(tables().cells, build(batch, lobe, 0));
    }
}

}  // namespace shadowcache
