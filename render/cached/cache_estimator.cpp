// The cache as a control variate: what the counts predict is integrated exactly over the regions,
// and rays are spent on the difference, where the counts are least sure. The mathematics:
// docs/estimator.md.

#include "render/cached/cache_estimator.h"

#include <algorithm>
#include <cmath>

#include "common/base/stopwatch.h"
#include "common/random/salts.h"
#include "common/random/sequence.h"
#include "render/cached/cache_pilot.h"
#include "render/cached/cache_plan.h"
#include "render/cached/cache_workspace.h"
#include "render/cached/openness_meter.h"

namespace shadowcache {

namespace {

class CacheEstimator final : public Estimator,
                             private FramePilot,
                             private LightPrediction,
                             private InsightSource {
public:
    CacheEstimator(const EstimatorContext& context, const CacheOptions& options)
        : Estimator(context), options_(options) {}

    const FramePilot* pilot() const override { return this; }
    bool isAdaptive() const override { return options_.adaptive; }
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
                estimates[i].irradiance = countedPreview(batch.points[i].place, w);
            w.setupNanoseconds += watch.sinceLast();
            return;
        }
        if (batch.predict)
            for (std::size_t i = 0; i < batch.points.size(); ++i)
                estimates[i].predicted = countedPreview(batch.points[i].place, w);
        const CachedBatch lit{context_, planOf(batch.plan), batch, w.lookup, w};
        CosineLight light(lit, splitter_, w.cosines);
        lightBatch(lit, light, w.cosines, estimates);
    }

    void estimateGloss(const PointBatch& batch, std::span<const GlossyPoint> points,
                       Workspace& workspace, std::span<GlossEstimate> estimates) const override {
        auto& w = static_cast<CacheWorkspace&>(workspace);
        std::fill(estimates.begin(), estimates.end(), GlossEstimate{});
        if (context_.environment.luminanceIntegral() <= 0) return;
        LobeWorkspace& own = w.lobes;
        own.points.clear();
        for (const GlossyPoint& glossy : points) {
            ShadingPoint& point = own.points.emplace_back(glossy.point);
            point.slot.seed = hashWords(point.slot.seed, RenderSalt::glossCluster);
        }
        own.estimates.assign(points.size(), {});
        PointBatch ofLobes = batch;
        ofLobes.points = own.points;
        const CachedBatch lit{context_, planOf(batch.plan), ofLobes, w.lookup, w};
        LobeLight light(lit, points, lobeTables_.of(context_), splitter_.leastNoise(), own);
        if (batch.samples == 0) {
            Stopwatch watch;
            light.predict(own.estimates);
            w.traceNanoseconds += watch.sinceLast();
        } else {
            lightBatch(lit, light, own.tools, own.estimates);
        }
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Estimate& e = own.estimates[i];
            estimates[i] = {e.irradiance, e.variance, e.rays + e.reused};
        }
    }

private:
    const CacheOptions options_;
    const CellSplitter splitter_{context_.environment, context_.cache->header().tiers()};
    const LazyLobeTables lobeTables_{};
    const OpennessMeter openness_{context_.cache->header().tiers()};
    const CachePlan unplanned_{};  ///< what holds without a pilot

    const CachePlan& planOf(const EstimatorPlan* plan) const {
        return plan ? static_cast<const CachePlan&>(*plan) : unplanned_;
    }

    std::unique_ptr<const EstimatorPlan> plan(std::span<const ShadingPoint> points, int samples,
                                              double cameraRayError) const override {
        return planByCache(context_, options_.adaptive, points, samples, cameraRayError);
    }

    CacheInsight insight(const ShadingPoint& point, int samples, const EstimatorPlan* ofFrame,
                         Workspace& workspace) const override {
        const CachePlan& plan = planOf(ofFrame);
        auto& w = static_cast<CacheWorkspace&>(workspace);
        CacheInsight insight;
        const SetPlace& place = point.place;
        insight.items = w.lookup.pool(context_.scene, place, 0);
        insight.openness = openness_.measure(w.lookup.pooled(), place.normal);
        const Regions& regions =
            w.cosines.builder
                .build(CosineIntegrand(context_.environment, splitter_, place.normal, 0, 0),
                       w.lookup.pooled(), plan.calibration)
                .regions;
        for (const RegionGroup& group : regions.groups)
            insight.regions +=
                static_cast<int>(std::count_if(group.deviation, group.deviation + kBlockCells,
                                               [](float deviation) { return deviation > 0; }));
        if (samples > 0)
            insight.expectedNoise = static_cast<float>(
                deviationOf(regions) /
                std::sqrt(plan.samplesOf(plan.noiseOf(regions, point.slot), samples) *
                          static_cast<double>(point.slot.sampleFraction)));
        return insight;
    }

    /// The irradiance without any ray. What moves hides other things from each pixel; without it
    /// items can be summed up once for all pixels.
    Rgb preview(const SetPlace& place, CacheWorkspace& w, IrradianceWithoutRays& predicted,
                bool& known) const {
        if (!context_.scene.movingBalls().empty()) {
            known = w.lookup.pool(context_.scene, place, 0) > 0;
            return predicted.preview.irradiance(w.lookup.pooled(), place.normal);
        }
        const std::span<const ItemView> found = w.lookup.find(place);
        known = !found.empty();
        return predicted.byItem.mean(found, place.normal);
    }

    Rgb countedPreview(const SetPlace& place, CacheWorkspace& w) const {
        bool known = false;
        const Rgb irradiance = preview(place, w, w.preview, known);
        w.pointsWithoutItems += known ? 0 : 1;
        return irradiance;
    }

    Rgb predict(const SetPlace& place, Workspace& workspace) const override {
        bool known = false;
        auto& w = static_cast<CacheWorkspace&>(workspace);
        return preview(place, w, w.rough, known);
    }
};

}  // namespace

std::unique_ptr<Estimator> makeCacheEstimator(const EstimatorContext& context,
                                              const CacheOptions& options) {
    return std::make_unique<CacheEstimator>(context, options);
}

}  // namespace shadowcache
