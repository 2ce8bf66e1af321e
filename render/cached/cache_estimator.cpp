// The cache as a control variate: what the counts predict is integrated exactly over the regions,
// and rays are spent on the difference, where the counts are least sure. The mathematics:
// docs/estimator.md.

#include "render/cached/cache_estimator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "common/base/parallel.h"
#include "common/base/tuned.h"
#include "common/random/salts.h"
#include "common/random/sequence.h"
#include "render/cached/cache_insight.h"
#include "render/cached/cache_workspace.h"
#include "render/cached/cluster_lighting.h"
#include "render/cached/control_variate.h"
#include "render/cached/glossy_cache.h"
#include "render/cached/heaviness.h"
#include "render/cached/sample_budget.h"

namespace shadowcache {

namespace {

/// Irradiance, as a share of the frame's mean, below which errors count no more.
SHADOWCACHE_TUNED(double, kDarkest, 0.1);

/// Irradiance, as a share of the frame's mean, below which errors are absolute, as relMSE has it.
constexpr double kFloor = 0.1;

/// How much of the light that is predicted but not sure makes a place bright, whose samples are
/// then not heavy.
SHADOWCACHE_TUNED(double, kUnsureShare, 0.4);
/// Places of a pilot that one thread takes at a time.
constexpr std::size_t kPilotChunk = 32;

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
            traceCluster(context_, batch, prepared.regions, prepared.plan, prepared.samples, run);
            w.traceNanoseconds += watch.sinceLast();
        }
        reuse.finish(context_.scene, estimates);
        w.traceNanoseconds += watch.sinceLast();
    }

    void estimateGloss(const PointBatch& batch, std::span<const GlossyPoint> points,
                       Workspace& workspace, std::span<GlossEstimate> estimates) const override {
        auto& w = static_cast<CacheWorkspace&>(workspace);
        std::fill(estimates.begin(), estimates.end(), GlossEstimate{});
        glossy_.estimate(batch, points, {calibration_, darkest_ / kPi}, w.lookup, w.tools, w.glossy,
                         w, estimates);
    }

private:
    const CacheOptions options_;
    GlossyCache glossy_{context_};
    const OpennessMeter openness_{context_.cache->header().tiers()};
    Calibration calibration_;
    std::optional<SampleBudget> budget_;  ///< once a pilot ran, if samples are shared out
    double splitNoise_ = 0;               ///< of a cell, times samples, below which it stays whole
    double darkest_ = 0;     ///< irradiance below which errors count no more [luminance]
    double floor_ = 1;       ///< irradiance below which errors are absolute [luminance]
    double heavy_ = kHeavy;  ///< part of a point's brightness from which on samples are reused

    std::uint64_t run(std::span<const ShadingPoint> points, int samples,
                      double otherError) override {
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
        const std::vector<PredictedPlace> predicted = predictPlaces(points);
        double brightness = 0, fine = 0, coarse = 0;
        for (const PredictedPlace& p : predicted) {
            const double part = 1 / static_cast<double>(predicted.size());
            brightness += part * p.luminance;
            fine += part * p.fine;
            coarse += part * p.coarse;
        }
        splitNoise_ = splitNoise(fine, coarse);
        darkest_ = kDarkest * brightness;
        floor_ = std::max(kFloor * brightness, 1e-15);
        if (options_.adaptive) {
            std::vector<PredictedNoise> noise;
            for (std::size_t i = 0; i < points.size(); ++i)
                noise.push_back(noiseOf(predicted[i], points[i]));
            budget_.emplace(noise, samples);
        }
        heavy_ = findHeavy(points, samples, otherError);
        return std::accumulate(rays.begin(), rays.end(), std::uint64_t{0});
    }

    CacheInsight insight(const ShadingPoint& point, int samples,
                         Workspace& workspace) const override {
        auto& w = static_cast<CacheWorkspace&>(workspace);
        CacheInsight insight;
        insight.items = pool(point, 0, w);
        insight.openness = openness_.measure(w.lookup.pooled(), point.normal);
        const Regions& regions =
            w.regionBuilder.build(w.lookup.pooled(), point.normal, 0, calibration_, 0);
        for (const RegionGroup& group : regions.groups)
            insight.regions +=
                static_cast<int>(std::count_if(group.deviation, group.deviation + kBlockCells,
                                               [](float deviation) { return deviation > 0; }));
        if (samples > 0)
            insight.expectedNoise = static_cast<float>(
                deviationOf(regions) /
                std::sqrt(shareOf(noiseOf(predictedOf(regions), point), samples) *
                          static_cast<double>(point.share)));
        return insight;
    }

    /// What the cache predicts of a place: its irradiance, and the standard deviation of a sample.
    struct Predicted {
        double luminance = 0, deviation = 0;
    };

    /// The same of a place of the pilot, and the sums of what its regions deviate: split as far as
    /// they can be, and not at all.
    struct PredictedPlace : Predicted {
        double fine = 0, coarse = 0;
    };

    static Predicted predictedOf(const Regions& regions) {
        return {regions.predictedLuminance, deviationOf(regions)};
    }

    std::vector<PredictedPlace> predictPlaces(std::span<const ShadingPoint> points) const {
        std::vector<PredictedPlace> predicted(points.size());
        parallelFor(points.size(), kPilotChunk, [&](const Chunk& chunk) {
            const auto workspace = makeWorkspace();
            auto& w = static_cast<CacheWorkspace&>(*workspace);
            for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
                const Regions& fine = lookAt(points[i], w);
                predicted[i] = {predictedOf(fine), fine.deviationSum};
                const Regions& coarse =
                    w.regionBuilder.build(w.lookup.pooled(), points[i].normal, 0, calibration_,
                                          std::numeric_limits<float>::max());
                predicted[i].coarse = coarse.deviationSum;
            }
        });
        return predicted;
    }

    /// Heaviness from which on samples are reused, as if each pixel had kJudgedSamples.
    double findHeavy(std::span<const ShadingPoint> points, int samples, double otherError) const {
        std::vector<VarianceByHeaviness> parts((points.size() + kPilotChunk - 1) / kPilotChunk);
        parallelFor(points.size(), kPilotChunk, [&](const Chunk& chunk) {
            const auto workspace = makeWorkspace();
            auto& w = static_cast<CacheWorkspace&>(*workspace);
            for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
                const Regions& regions = lookAt(points[i], w);
                const PredictedNoise noise = noiseOf(predictedOf(regions), points[i]);
                parts[chunk.index].add(
                    varianceByHeaviness(regions, PlanRules(), brightnessRule(), noise.scale),
                    samples / (kJudgedSamples * shareOf(noise, samples)),
                    1 / static_cast<double>(points.size()));
            }
        });
        VarianceByHeaviness all;
        for (const VarianceByHeaviness& part : parts) all.add(part, 1, 1);
        return all.heavyFrom(otherError);
    }

    Brightness brightnessRule() const {
        return {darkest_, budget_ ? kUnsureShare : kUnsureShareUniform};
    }

    PredictedNoise noiseOf(const Predicted& predicted, const ShadingPoint& point) const {
        return {predicted.deviation, point.errorScale > 0
                                         ? static_cast<double>(point.errorScale)
                                         : std::hypot(predicted.luminance, floor_)};
    }

    /// Samples of a point of so much noise, where `samples` are the mean.
    double shareOf(const PredictedNoise& noise, int samples) const {
        return budget_ ? budget_->shareOf(noise) : samples;
    }

    /// Samples of each point of a cluster go to `tools.wanted`, and the irradiance from which on
    /// one is heavy to `tools.heavyFrom`.
    ///
    /// @return mean of those of its camera rays that were asked for
    double shareOut(const PointBatch& batch, std::span<const std::uint32_t> members,
                    const Predicted& predicted, ClusterTools& tools) const {
        tools.wanted.clear();
        tools.heavyFrom.clear();
        double samples = 0, rays = 0;
        for (const std::uint32_t member : members) {
            const ShadingPoint& point = batch.points[member];
            const PredictedNoise noise = noiseOf(predicted, point);
            const auto part = static_cast<double>(point.share);
            tools.wanted.push_back(part * shareOf(noise, batch.samples));
            tools.heavyFrom.push_back(heavy_ * noise.scale * kJudgedSamples /
                                      (batch.samples * part));
            samples += tools.wanted.back();
            rays += part;
        }
        return samples / rays;
    }

    int pool(const ShadingPoint& point, float radius, CacheWorkspace& w) const {
        return w.lookup.pool(context_.scene, point, radius);
    }

    /// The regions of one point.
    const Regions& lookAt(const ShadingPoint& point, CacheWorkspace& w) const {
        pool(point, 0, w);
        return w.regionBuilder.build(w.lookup.pooled(), point.normal, 0, calibration_, 0);
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
        return budget_ ? std::optional(budget_->predictedError()) : std::nullopt;
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
        const auto members = w.tools.membersOf(cluster);
        double samples = 0;
        for (const std::uint32_t member : members)
            samples += static_cast<double>(batch.points[member].share) * batch.samples;
        const Regions& regions =
            w.regionBuilder.build(w.lookup.pooled(), centre.normal, cluster.tilt, calibration_,
                                  static_cast<float>(splitNoise_ / samples));
        const double share = shareOut(batch, members, predictedOf(regions), w.tools);
        const SamplingPlan& plan = w.planner.plan(regions, kJudgedSamples * share / batch.samples,
                                                  brightnessRule(), heavy_);
        const ControlVariate predicted(context_.environment, regions, plan);
        for (const std::uint32_t point : members)
            estimates[point].irradiance = predicted.integral(batch.points[point].normal);
        const ShadingPoint& first = batch.points[members.front()];
        const std::span<const PointShare> shares =
            sharePoints(w.tools.wanted,
                        toUnit(hashWords(first.seed, RenderSalt::shareRounding, first.cameraRay)),
                        w.tools.shares);
        RegionDistribution& distribution = w.tools.distribution;
        distribution.assign(regions, plan);
        reuse.addCluster(regions, plan, distribution, members, shares, w.tools.heavyFrom);
        return {regions, plan,
                w.tools.sampler.draw(batch, members, shares, distribution, context_.sequence)};
    }
};

}  // namespace

std::unique_ptr<Estimator> makeCache(const EstimatorContext& context, const CacheOptions& options) {
    return std::make_unique<CacheEstimator>(context, options);
}

}  // namespace shadowcache
