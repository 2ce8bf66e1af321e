// The cache as a control variate: what the counts predict is integrated exactly over the regions,
// and rays are spent on the difference, where the counts are least sure. The mathematics:
// docs/estimator.md.

#include "render/cached/cache_estimator.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/random/salts.h"
#include "common/random/sequence.h"
#include "render/cached/cache_insight.h"
#include "render/cached/cache_pilot.h"
#include "render/cached/cache_plan.h"
#include "render/cached/cache_workspace.h"
#include "render/cached/cluster_lighting.h"
#include "render/cached/glossy_cache.h"

namespace shadowcache {

namespace {

class CacheEstimator final : public Estimator,
                             private FramePilot,
                             private LightPrediction,
                             private InsightSource {
public:
    CacheEstimator(const EstimatorContext& context, const CacheOptions& options)
        : Estimator(context), options_(options) {}

    FramePilot* pilot() override { return this; }
    const LightPrediction* prediction() const override { return this; }
    const InsightSource* insights() const override { return this; }

    std::unique_ptr<Workspace> makeWorkspace() const override {
        return std::make_unique<CacheWorkspace>(*context_.cache, context_.environment);
    }

    using Estimator::estimate;
    void estimate(const PointBatch& batch, Workspace& workspace,
                  std::span<Estimate> estimates) const override {
        auto& w = static_cast<CacheWorkspace&>(workspace);
        std::fill(estimates.begin(), estimates.end(), Estimate{});
        Stopwatch watch;
        if (batch.samples == 0) {
            for (std::size_t i = 0; i < batch.points.size(); ++i)
                estimates[i].irradiance = countedPreview(batch.points[i], w);
            w.setupNanoseconds += watch.sinceLast();
            return;
        }
        if (batch.predict)
            for (std::size_t i = 0; i < batch.points.size(); ++i)
                estimates[i].predicted = countedPreview(batch.points[i], w);
        w.tools.clusters.build(batch.points, context_.cache->header().spacing, batch.cameraRays,
                               batch.samples);
        NeighborReuse::Batch reuse = w.tools.reuse.begin(batch, w.tools.clusters);
        for (const PointCluster& cluster : w.tools.clusters.clusters()) {
            const Prepared prepared = prepare(batch, cluster, w, reuse, estimates);
            if (w.watchedPixel)
                for (const ClusterSample& sample : prepared.samples)
                    w.watch(batch.points[sample.point],
                            sample.finish(context_.environment).direction);
            w.setupNanoseconds += watch.sinceLast();
            SampleTracer::Run run =
                w.tools.tracer.begin(context_, batch, w.tools.membersOf(cluster), reuse, estimates);
            traceCluster(context_, batch, prepared.fitted, prepared.plan, prepared.samples, run);
            w.traceNanoseconds += watch.sinceLast();
        }
        reuse.finish(context_.scene, estimates);
        w.traceNanoseconds += watch.sinceLast();
    }

    void estimateGloss(const PointBatch& batch, std::span<const GlossyPoint> points,
                       Workspace& workspace, std::span<GlossEstimate> estimates) const override {
        auto& w = static_cast<CacheWorkspace&>(workspace);
        std::fill(estimates.begin(), estimates.end(), GlossEstimate{});
        glossy_.estimate(batch, points, {plan_.calibration, plan_.darkest / kPi}, w.lookup, w.tools,
                         w.glossy, w, estimates);
    }

private:
    const CacheOptions options_;
    GlossyCache glossy_{context_};
    const OpennessMeter openness_{context_.cache->header().tiers()};
    CachePlan plan_;

    std::uint64_t run(std::span<const ShadingPoint> points, int samples,
                      double otherError) override {
        const PilotResult result =
            runCachePilot(context_, options_.adaptive, points, samples, otherError);
        plan_ = result.plan;
        return result.rays;
    }

    CacheInsight insight(const ShadingPoint& point, int samples,
                         Workspace& workspace) const override {
        auto& w = static_cast<CacheWorkspace&>(workspace);
        CacheInsight insight;
        insight.items = pool(point, 0, w);
        insight.openness = openness_.measure(w.lookup.pooled(), point.normal);
        const Regions& regions = regionsOf(point.normal, 0, 0, w).regions;
        for (const RegionGroup& group : regions.groups)
            insight.regions +=
                static_cast<int>(std::count_if(group.deviation, group.deviation + kBlockCells,
                                               [](float deviation) { return deviation > 0; }));
        if (samples > 0)
            insight.expectedNoise = static_cast<float>(
                deviationOf(regions) /
                std::sqrt(plan_.samplesOf(plan_.noiseOf(regions, point), samples) *
                          static_cast<double>(point.share)));
        return insight;
    }

    /// Samples of each point of a cluster go to `tools.wanted`, and the irradiance from which on
    /// one is heavy to `tools.heavyFrom`.
    ///
    /// @return mean of those of its camera rays that were asked for
    double shareOut(const PointBatch& batch, std::span<const std::uint32_t> members,
                    const Regions& regions, ClusterTools& tools) const {
        tools.wanted.clear();
        tools.heavyFrom.clear();
        double samples = 0, rays = 0;
        for (const std::uint32_t member : members) {
            const ShadingPoint& point = batch.points[member];
            const PredictedNoise noise = plan_.noiseOf(regions, point);
            const auto part = static_cast<double>(point.share);
            tools.wanted.push_back(part * plan_.samplesOf(noise, batch.samples));
            tools.heavyFrom.push_back(plan_.heavy * noise.scale * kJudgedSamples /
                                      (batch.samples * part));
            samples += tools.wanted.back();
            rays += part;
        }
        return samples / rays;
    }

    int pool(const ShadingPoint& point, float radius, CacheWorkspace& w) const {
        return w.lookup.pool(context_.scene, point, radius);
    }

    /// The regions above a cluster around the place that was pooled last.
    const FittedRegions<CosineIntegrand>& regionsOf(const Vec3f& normal, float tilt,
                                                    float leastNoise, CacheWorkspace& w) const {
        return w.regionBuilder.build(
            CosineIntegrand(context_.environment, w.splitter, normal, tilt, leastNoise),
            w.lookup.pooled(), plan_.calibration);
    }

    /// The irradiance without any ray. What moves hides other things from each pixel; without it
    /// items can be summed up once for all pixels.
    Rgb preview(const ShadingPoint& point, CacheWorkspace& w, IrradianceWithoutRays& predicted,
                bool& known) const {
        if (!context_.scene.movingBalls().empty()) {
            known = pool(point, 0, w) > 0;
            return predicted.preview.irradiance(w.lookup.pooled(), point.normal);
        }
        const std::span<const ItemView> found = w.lookup.find(point);
        known = !found.empty();
        return predicted.byItem.mean(found, point.normal);
    }

    Rgb countedPreview(const ShadingPoint& point, CacheWorkspace& w) const {
        bool known = false;
        const Rgb irradiance = preview(point, w, w.preview, known);
        w.pointsWithoutItems += known ? 0 : 1;
        return irradiance;
    }

    Rgb predict(const ShadingPoint& point, Workspace& workspace) const override {
        bool known = false;
        auto& w = static_cast<CacheWorkspace&>(workspace);
        return preview(point, w, w.rough, known);
    }

    std::optional<double> predictedError() const override {
        return plan_.budget ? std::optional(plan_.budget->predictedError()) : std::nullopt;
    }

    /// All that is decided of a cluster before any ray; valid until the next one is prepared.
    struct Prepared {
        const FittedRegions<CosineIntegrand>& fitted;
        const SamplingPlan& plan;
        std::span<const ClusterSample> samples;
    };

    /// Prepares a cluster; what the cache predicts of its points goes to their estimates.
    Prepared prepare(const PointBatch& batch, const PointCluster& cluster, CacheWorkspace& w,
                     NeighborReuse::Batch& reuse, std::span<Estimate> estimates) const {
        const ShadingPoint& centre = batch.points[cluster.centre];
        if (pool(centre, cluster.radius, w) == 0)
            w.pointsWithoutItems += cluster.end - cluster.begin;
        const auto members = w.tools.membersOf(cluster);
        double samples = 0;
        for (const std::uint32_t member : members)
            samples += static_cast<double>(batch.points[member].share) * batch.samples;
        const FittedRegions<CosineIntegrand>& fitted = regionsOf(
            centre.normal, cluster.tilt, static_cast<float>(plan_.splitNoise / samples), w);
        const Regions& regions = fitted.regions;
        const double mean = shareOut(batch, members, regions, w.tools);
        const SamplingPlan& plan = w.planner.plan(regions, kJudgedSamples * mean / batch.samples,
                                                  plan_.brightness(), plan_.heavy);
        const CosineIntegral predicted(context_.environment, fitted, plan);
        for (const std::uint32_t point : members)
            estimates[point].irradiance = predicted.at(batch.points[point].normal);
        const ShadingPoint& first = batch.points[members.front()];
        const std::span<const PointShare> shares =
            sharePoints(w.tools.wanted,
                        toUnit(hashWords(first.seed, RenderSalt::shareRounding, first.cameraRay)),
                        w.tools.shares);
        RegionDistribution& distribution = w.tools.distribution;
        distribution.assign(regions, plan);
        reuse.addCluster(regions, plan, distribution, members, shares, w.tools.heavyFrom);
        return {fitted, plan,
                w.tools.sampler.draw(batch, members, shares, distribution, context_.sequence)};
    }
};

}  // namespace

std::unique_ptr<Estimator> makeCache(const EstimatorContext& context, const CacheOptions& options) {
    return std::make_unique<CacheEstimator>(context, options);
}

}  // namespace shadowcache
