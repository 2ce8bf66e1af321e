// The cache as a control variate: what the counts predict is integrated exactly over the regions,
// and rays are spent on the difference, where the counts are least sure. The mathematics:
// docs/estimator.md.

#include "render/cached/cache_estimator.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <optional>

#include "common/base/parallel.h"
#include "common/base/tuned.h"
#include "common/predict/cache_preview.h"
#include "common/predict/item_irradiance.h"
#include "common/random/salts.h"
#include "common/random/sequence.h"
#include "render/cached/cache_insight.h"
#include "render/cached/cache_pilot.h"
#include "render/cached/cluster_lighting.h"
#include "render/cached/control_variate.h"
#include "render/cached/glossy_lighting.h"
#include "render/cached/sample_budget.h"

namespace shadowcache {

namespace {

/// Irradiance, as a share of the frame's mean, below which errors count no more.
SHADOWCACHE_TUNED(double, kDarkest, 0.1);

/// How much of the light that is predicted but not sure makes a place bright, whose samples are
/// then not heavy.
SHADOWCACHE_TUNED(double, kUnsureShare, 0.4);
/// The same with the uniform budget, which gives no more samples to places that turn out dark.
SHADOWCACHE_TUNED(double, kUnsureShareUniform, 0.2);

/// Whatever number of samples is asked for, the same regions are reused as with so many: what is
/// not reused then falls as all the noise does.
SHADOWCACHE_TUNED(double, kJudgedSamples, 64);

/// SamplingPlanner's share in samples of lobes, which differ from the central one that is planned
/// for.
SHADOWCACHE_TUNED(double, kGlossyDefensiveShare, 0.8);

/// Least width of a lobe that quadratics over the finest cells follow; regions are chosen for
/// narrower ones as if they were so wide.
SHADOWCACHE_TUNED(float, kLeastFittedAlpha, 0.03f);

/// Places of a pilot that one thread takes at a time.
constexpr std::size_t kPilotChunk = 32;

struct CacheWorkspace final : Workspace {
    CacheWorkspace(const ShadowCache& cache, const Environment& environment)
        : reader(cache),
          items(ShadowCache::kMaxItems),
          pooled(cache.header().tiers()),
          preview(environment, cache.header().tiers()),
          itemIrradiance(preview),
          regionBuilder(environment, cache.header().tiers()),
          sampler(environment),
          reuse(environment, cache.header().tiers()),
          glossyBuilder(environment, cache.header().tiers()) {}

    ShadowCache::Reader reader;
    std::vector<ItemView> items;
    PooledVisibility pooled;
    CachePreview preview;
    ItemIrradiance itemIrradiance;
    PilotRays pilotRays;
    RegionBuilder regionBuilder;
    SamplingPlanner planner;
    std::vector<PointShare> shares;
    PointClusters clusters;
    ClusterSampler sampler;
    NeighborReuse reuse;
    SampleTracer tracer;
    std::vector<ShadingPoint> glossyPoints;
    std::vector<Estimate> glossyEstimates;
    GlossyRegionBuilder glossyBuilder;
    SamplingPlanner glossyPlanner{kGlossyDefensiveShare};
    std::vector<LobeMatch::Fit> matches;
    std::vector<PointShare> lobeShares;
    GlossyLighting glossyLighting;
};

class CacheEstimator final : public Estimator, private FramePilot, private InsightSource {
public:
    CacheEstimator(const EstimatorContext& context, const CacheOptions& options)
        : Estimator(context), options_(options) {}

    FramePilot* pilot() override { return this; }
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
                estimates[i].irradiance = preview(batch.points[i], w);
            w.setupNanoseconds += watch.sinceLast();
            return;
        }
        if (batch.predict)
            for (std::size_t i = 0; i < batch.points.size(); ++i)
                estimates[i].predicted = preview(batch.points[i], w);
        w.clusters.build(batch.points, context_.cache->header().spacing);
        NeighborReuse::Batch reuse = w.reuse.begin(batch, w.clusters);
        for (const PointCluster& cluster : w.clusters.clusters()) {
            const Prepared prepared = prepare(batch, cluster, w, reuse, estimates);
            if (w.watchedPixel)
                for (const ClusterSample& sample : prepared.samples)
                    w.watch(batch.points[sample.point],
                            sample.finish(context_.environment).direction);
            w.setupNanoseconds += watch.sinceLast();
            const auto members = membersOf(cluster, w);
            SampleTracer::Run run = w.tracer.begin(context_, batch, members, reuse, estimates);
            traceCluster(context_, batch, prepared.regions, prepared.plan, prepared.samples, run);
            w.traceNanoseconds += watch.sinceLast();
        }
        reuse.finish(context_.scene, estimates);
        w.traceNanoseconds += watch.sinceLast();
    }

    /// Light is drawn from the regions of clusters, by the visibility that is predicted.
    void estimateGloss(const PointBatch& batch, std::span<const GlossyPoint> points,
                       Workspace& workspace, std::span<GlossEstimate> estimates) const override {
        auto& w = static_cast<CacheWorkspace&>(workspace);
        std::fill(estimates.begin(), estimates.end(), GlossEstimate{});
        if (batch.samples == 0 || context_.environment.luminanceIntegral() <= 0) return;
        std::call_once(tablesMade_, [&] {
            tables_.emplace(context_.environment, context_.cache->header().tiers());
        });
        Stopwatch watch;
        w.glossyPoints.clear();
        for (const GlossyPoint& glossy : points) {
            ShadingPoint& point = w.glossyPoints.emplace_back(glossy.point);
            point.seed = hashWords(point.seed, RenderSalt::gloss);
        }
        w.glossyEstimates.assign(points.size(), {});
        PointBatch own = batch;
        own.points = w.glossyPoints;
        w.clusters.build(own.points, context_.cache->header().spacing);
        NeighborReuse::Batch reuse = w.reuse.begin(own, w.clusters, points);
        for (const PointCluster& cluster : w.clusters.clusters()) {
            const auto members = membersOf(cluster, w);
            const GlossyCluster prepared = prepareGloss(own, points, cluster, w, reuse);
            const std::span<const ClusterSample> samples =
                w.sampler.draw(own, members, prepared.ofRegions, prepared.regions.regions,
                               prepared.plan, context_.sequence);
            w.setupNanoseconds += watch.sinceLast();
            SampleTracer::Run run =
                w.tracer.begin(context_, own, members, reuse, w.glossyEstimates);
            w.glossyLighting.trace(context_, *tables_, own, points, prepared, samples, run);
            w.traceNanoseconds += watch.sinceLast();
        }
        reuse.finish(context_.scene, w.glossyEstimates);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Estimate& e = w.glossyEstimates[i];
            estimates[i] = {e.irradiance, e.variance, e.rays + e.reused};
        }
        w.traceNanoseconds += watch.sinceLast();
    }

private:
    const CacheOptions options_;
    mutable std::once_flag tablesMade_;
    mutable std::optional<GlossyTables> tables_;  ///< once a glossy point was met
    const OpennessMeter openness_{context_.cache->header().tiers()};
    Calibration calibration_;
    std::optional<SampleBudget> budget_;  ///< once a pilot ran, if samples are shared out
    double darkest_ = 0;  ///< irradiance below which errors count no more [luminance]

    std::uint64_t run(std::span<const ShadingPoint> points, int samples) override {
        calibration_ = Calibration();
        std::vector<Calibration> found((points.size() + kPilotChunk - 1) / kPilotChunk);
        std::vector<std::uint64_t> rays(found.size());
        parallelFor(points.size(), kPilotChunk, [&](const Chunk& chunk) {
            const auto workspace = makeWorkspace();
            auto& w = static_cast<CacheWorkspace&>(*workspace);
            for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
                rays[chunk.index] += w.pilotRays.trace(context_, points[i], lookAt(points[i], w),
                                                       w.samples, found[chunk.index]);
            }
        });
        for (const Calibration& part : found) calibration_.add(part);
        calibration_.update();
        const std::vector<PredictedNoise> noise = predictNoise(points);
        double brightness = 0;
        for (const PredictedNoise& n : noise) brightness += n.value;
        darkest_ = noise.empty() ? 0 : kDarkest * brightness / static_cast<double>(noise.size());
        if (options_.adaptive) budget_.emplace(noise, samples);
        return std::accumulate(rays.begin(), rays.end(), std::uint64_t{0});
    }

    CacheInsight insight(const ShadingPoint& point, int samples,
                         Workspace& workspace) const override {
        auto& w = static_cast<CacheWorkspace&>(workspace);
        CacheInsight insight;
        insight.items = pool(point, 0, w);
        insight.openness = openness_.measure(w.pooled, point.normal);
        const Regions& regions = w.regionBuilder.build(w.pooled, point.normal, 0, calibration_);
        for (const RegionGroup& group : regions.groups)
            insight.regions +=
                static_cast<int>(std::count_if(group.deviation, group.deviation + kBlockCells,
                                               [](float deviation) { return deviation > 0; }));
        if (samples > 0)
            insight.expectedNoise =
                static_cast<float>(deviationOf(regions) / std::sqrt(shareOf(regions, samples)));
        return insight;
    }

    std::vector<PredictedNoise> predictNoise(std::span<const ShadingPoint> points) const {
        std::vector<PredictedNoise> noise(points.size());
        parallelFor(points.size(), kPilotChunk, [&](const Chunk& chunk) {
            const auto workspace = makeWorkspace();
            auto& w = static_cast<CacheWorkspace&>(*workspace);
            for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
                noise[i] = predictedNoise(lookAt(points[i], w));
            }
        });
        return noise;
    }

    static PredictedNoise predictedNoise(const Regions& regions) {
        return {deviationOf(regions), regions.predictedLuminance};
    }

    /// Samples of a point with these regions, where `samples` are the mean.
    double shareOf(const Regions& regions, int samples) const {
        return budget_ ? budget_->shareOf(predictedNoise(regions)) : samples;
    }

    std::span<const ItemView> lookUp(const ShadingPoint& point, CacheWorkspace& w) const {
        const int found = w.reader.lookUp(point.position, point.geometricNormal, w.items);
        return std::span(w.items).first(static_cast<std::size_t>(found));
    }

    /// Pools the counts around a point, for it and all points within `radius`.
    ///
    /// @return number of items found
    int pool(const ShadingPoint& point, float radius, CacheWorkspace& w) const {
        const std::span<const ItemView> found = lookUp(point, w);
        w.pooled.pool(found);
        for (const Ball& ball : context_.scene.movingBalls())
            addOccluderCone({ball.center, ball.radius + radius}, point, w.pooled);
        return static_cast<int>(found.size());
    }

    /// The regions of one point.
    const Regions& lookAt(const ShadingPoint& point, CacheWorkspace& w) const {
        pool(point, 0, w);
        return w.regionBuilder.build(w.pooled, point.normal, 0, calibration_);
    }

    /// The irradiance without any ray. What moves hides other things from each pixel; without it
    /// items can be summed up once for all pixels.
    Rgb preview(const ShadingPoint& point, CacheWorkspace& w) const {
        if (!context_.scene.movingBalls().empty()) {
            w.pointsWithoutItems += pool(point, 0, w) == 0 ? 1 : 0;
            return w.preview.irradiance(w.pooled, point.normal);
        }
        const std::span<const ItemView> found = lookUp(point, w);
        w.pointsWithoutItems += found.empty() ? 1 : 0;
        return w.itemIrradiance.mean(found, point.normal);
    }

    /// The counts do not include what moves.
    static void addOccluderCone(const Ball& ball, const ShadingPoint& point,
                                PooledVisibility& pooled) {
        const Vec3f towards = ball.center - point.rayOrigin;
        const float distance = towards.length();
        if (distance > ball.radius)
            pooled.addOccluderCone(towards / distance, std::asin(ball.radius / distance));
        else
            pooled.addOccluderCone(point.geometricNormal, static_cast<float>(kPi));
    }

    static std::span<const std::uint32_t> membersOf(const PointCluster& cluster,
                                                    const CacheWorkspace& w) {
        return w.clusters.order().subspan(cluster.begin, cluster.end - cluster.begin);
    }

    /// Prepares a cluster of glossy points; what the cache predicts of them goes to their
    /// estimates.
    GlossyCluster prepareGloss(const PointBatch& batch, std::span<const GlossyPoint> points,
                               const PointCluster& cluster, CacheWorkspace& w,
                               NeighborReuse::Batch& reuse) const {
        const auto members = membersOf(cluster, w);
        const GlossyLobe& given = points[cluster.centre].lobe;
        const GlossyLobe lobe = given.widened(kLeastFittedAlpha);
        pool(batch.points[cluster.centre], cluster.radius, w);
        float misfit = 0;
        w.matches.clear();
        const LobeMatch match(given);
        for (const std::uint32_t point : members) {
            LobeMatch::Fit& fit = w.matches.emplace_back(match.fit(points[point].lobe));
            if (given.alpha() < kLeastFittedAlpha) fit = {};
            misfit += fit.misfit / static_cast<float>(members.size());
        }
        const GlossyRegions& glossy =
            w.glossyBuilder.build(tables_->cells, w.pooled, lobe, misfit, calibration_);
        const double share = batch.samples;
        const SamplingPlan& plan =
            w.glossyPlanner.plan(glossy.regions, kJudgedSamples * share / batch.samples,
                                 {darkest_ / kPi, kUnsureShareUniform});
        const Rgb integral = integralOf(tables_->cells, glossy, plan);
        for (std::size_t k = 0; k < members.size(); ++k)
            w.glossyEstimates[members[k]].irradiance = integral * w.matches[k].factor;
        const double ofLobes = lobeShare(given);
        const ShadingPoint& first = batch.points[members.front()];
        const auto offset = [&](RenderSalt salt) {
            return toUnit(hashWords(first.seed, salt, first.cameraRay));
        };
        const std::span<const PointShare> shares = sharePoints(
            members.size(), share * (1 - ofLobes), offset(RenderSalt::shareRounding), w.shares);
        const std::span<const PointShare> lobeShares = sharePoints(
            members.size(), share * ofLobes, offset(RenderSalt::glossRounding), w.lobeShares);
        reuse.addCluster(glossy.regions, plan, members, shares, lobeShares);
        return {members, shares, lobeShares, glossy, plan, w.matches};
    }

    /// All that is decided of a cluster before any ray; valid until the next one is prepared.
    struct Prepared {
        const Regions& regions;
        const SamplingPlan& plan;
        std::span<const ClusterSample> samples;
    };

    /// Prepares a cluster; what the cache predicts of its points goes to their estimates.
    Prepared prepare(const PointBatch& batch, const PointCluster& cluster, CacheWorkspace& w,
                     NeighborReuse::Batch& reuse, std::span<Estimate> estimates) const {
        const ShadingPoint& centre = batch.points[cluster.centre];
        if (pool(centre, cluster.radius, w) == 0)
            w.pointsWithoutItems += cluster.end - cluster.begin;
        const Regions& regions =
            w.regionBuilder.build(w.pooled, centre.normal, cluster.tilt, calibration_);
        const double share = shareOf(regions, batch.samples);
        const SamplingPlan& plan =
            w.planner.plan(regions, kJudgedSamples * share / batch.samples,
                           {darkest_, budget_ ? kUnsureShare : kUnsureShareUniform});
        const ControlVariate predicted(context_.environment, regions, plan);
        const auto members = membersOf(cluster, w);
        for (const std::uint32_t point : members)
            estimates[point].irradiance = predicted.integral(batch.points[point].normal);
        const ShadingPoint& first = batch.points[members.front()];
        const std::span<const PointShare> shares = sharePoints(
            members.size(), share,
            toUnit(hashWords(first.seed, RenderSalt::shareRounding, first.cameraRay)), w.shares);
        reuse.addCluster(regions, plan, members, shares);
        return {regions, plan,
                w.sampler.draw(batch, members, shares, regions, plan, context_.sequence)};
    }
};

}  // namespace

std::unique_ptr<Estimator> makeCache(const EstimatorContext& context, const CacheOptions& options) {
    return std::make_unique<CacheEstimator>(context, options);
}

}  // namespace shadowcache
