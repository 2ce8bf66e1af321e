// The cache as a control variate: what the counts predict is integrated exactly over the regions,
// and rays are spent on the difference, where the counts are least sure. The mathematics:
// docs/estimator.md.

#include "render/cached/cache_estimator.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "common/base/parallel.h"
#include "common/base/sequence.h"
#include "common/predict/cache_preview.h"
#include "common/predict/horizon.h"
#include "common/predict/item_irradiance.h"
#include "render/cached/cache_insight.h"
#include "render/cached/cache_survey.h"
#include "render/cached/region_sampler.h"
#include "render/cached/region_weights.h"
#include "render/cached/sample_budget.h"
#include "render/cached/surprise_exchange.h"

namespace shadowcache {

namespace {

/// Irradiance, as a share of the frame's mean, below which errors count no more.
constexpr double kDarkest = 0.1;

/// How much of the light that is predicted but not sure makes a place bright, whose samples are
/// then not heavy. Less with the uniform budget, which gives no more samples to places that turn
/// out dark.
constexpr double kUnsureShare = 0.4, kUnsureShareUniform = 0.2;

/// With more samples than this a camera ray, the same regions are shared as with so many: what
/// stays unshared falls as all the noise does.
constexpr double kJudgedSamples = 64;

/// Places of a survey that one thread takes at a time.
constexpr std::size_t kSurveyChunk = 32;

/// A sample of a region whose surprises are shared.
struct SharedSample {
    std::size_t index;  ///< in Workspace::samples
    Surprise surprise;
};

struct CacheWorkspace final : Workspace {
    CacheWorkspace(const ShadowCache& cache, const Environment& environment)
        : reader(cache),
          pooled(cache.header().tiers()),
          weights(environment, cache.header().tiers()),
          preview(environment, cache.header().tiers()),
          itemIrradiance(preview),
          items(ShadowCache::kMaxItems),
          sampler(environment),
          exchange(cache.header().tiers()) {}

    ShadowCache::Reader reader;
    PooledVisibility pooled;
    RegionWeights weights;
    CachePreview preview;
    ItemIrradiance itemIrradiance;
    std::vector<ItemView> items;
    CacheSurvey survey;
    RegionSampler sampler;
    SurpriseExchange exchange;
    std::vector<SharedSample> shared;
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
        std::vector<ShadingPoint> points;
        std::vector<Estimate> found;
        for (std::uint32_t k = batch.firstRay; k < batch.firstRay + batch.cameraRays; ++k) {
            points.clear();
            for (const ShadingPoint& p : batch.points)
                if (p.cameraRay == k) {
                    points.push_back(p);
                    points.back().seed = hashWords(p.seed, 90, k);
                }
            found.resize(points.size());
            light(points, batch.samples, static_cast<CacheWorkspace&>(workspace), found);
            std::size_t next = 0;
            for (std::size_t i = 0; i < batch.points.size(); ++i)
                if (batch.points[i].cameraRay == k) estimates[i] = found[next++];
        }
    }

private:
    void light(std::span<const ShadingPoint> points, int samples, CacheWorkspace& w,
               std::span<Estimate> estimates) const {
        Stopwatch watch;
        for (std::size_t i = 0; i < points.size(); ++i) {
            w.samples.clear();
            estimates[i] = {};
            estimates[i].irradiance = prepare(points[i], samples, w);
            w.setupNanoseconds += watch.sinceLast();
            if (w.samples.size() == 0) continue;
            w.samples.trace(context_.scene, points[i], context_.environment, estimates[i]);
            for (const SharedSample& s : w.shared)
                if (w.samples.open(s.index) == s.surprise.open) w.exchange.add(s.surprise);
            w.traceNanoseconds += watch.sinceLast();
        }
        w.exchange.exchange(context_.scene, context_.environment, points, estimates);
        w.exchange.clear();
        w.traceNanoseconds += watch.sinceLast();
    }

    std::uint64_t run(std::span<const ShadingPoint> points, int samples) override {
        reliability_ = Reliability();
        std::vector<Reliability> found((points.size() + kSurveyChunk - 1) / kSurveyChunk);
        std::vector<std::uint64_t> rays(found.size());
        parallelFor(points.size(), kSurveyChunk, [&](const Chunk& chunk) {
            const auto workspace = makeWorkspace();
            auto& w = static_cast<CacheWorkspace&>(*workspace);
            for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
                weigh(points[i], w);
                rays[chunk.index] += w.survey.look(context_.scene, context_.environment, points[i],
                                                   w.weights, w.samples, found[chunk.index]);
            }
        });
        for (const Reliability& part : found) reliability_.add(part);
        reliability_.update();
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
        insight.items = weigh(point, w);
        insight.openness = openness_.measure(w.pooled, point.normal);
        for (std::size_t g = 0; g < w.weights.size(); ++g)
            insight.regions += static_cast<int>(
                std::count_if(w.weights.spread(g), w.weights.spread(g) + kBlockCells,
                              [](float spread) { return spread > 0; }));
        if (samples > 0 && budget_) samples = budget_->samplesOf(predictedNoise(w), point.seed);
        if (samples > 0)
            insight.expectedNoise = static_cast<float>(w.weights.spreadSum() / std::sqrt(samples));
        return insight;
    }

    const CacheOptions options_;
    const OpennessMeter openness_{context_.cache->header().tiers()};
    Reliability reliability_;
    std::optional<SampleBudget> budget_;  ///< once a pilot ran, if samples are shared out
    double darkest_ = 0;  ///< irradiance below which errors count no more [luminance]

    std::vector<PredictedNoise> predictNoise(std::span<const ShadingPoint> points) const {
        std::vector<PredictedNoise> noise(points.size());
        parallelFor(points.size(), kSurveyChunk, [&](const Chunk& chunk) {
            const auto workspace = makeWorkspace();
            auto& w = static_cast<CacheWorkspace&>(*workspace);
            for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
                weigh(points[i], w);
                noise[i] = predictedNoise(w);
            }
        });
        return noise;
    }

    static PredictedNoise predictedNoise(const CacheWorkspace& w) {
        return {w.weights.spreadSum(), w.weights.predictedLuminance()};
    }

    std::span<const ItemView> lookUp(const ShadingPoint& point, CacheWorkspace& w) const {
        const int found = w.reader.lookUp(point.position, point.normal, w.items);
        return std::span(w.items).first(static_cast<std::size_t>(found));
    }

    /// @return number of items found
    int pool(const ShadingPoint& point, CacheWorkspace& w) const {
        const std::span<const ItemView> found = lookUp(point, w);
        w.pooled.pool(found);
        for (const Ball& ball : context_.scene.movingBalls())
            addOccluderCone(ball, point, w.pooled);
        return static_cast<int>(found.size());
    }

    int weigh(const ShadingPoint& point, CacheWorkspace& w) const {
        const int found = pool(point, w);
        w.weights.weigh(w.pooled, point.normal, reliability_);
        return found;
    }

    /// The irradiance without any ray. What moves hides other things from each pixel; without it
    /// items can be summed up once for all pixels.
    Rgb preview(const ShadingPoint& point, CacheWorkspace& w) const {
        if (!context_.scene.movingBalls().empty()) {
            pool(point, w);
            return w.preview.irradiance(w.pooled, point.normal);
        }
        return w.itemIrradiance.mean(lookUp(point, w), point.normal);
    }

    /// The counts know nothing of what moves.
    static void addOccluderCone(const Ball& ball, const ShadingPoint& point,
                                PooledVisibility& pooled) {
        const Vec3f towards = ball.center - point.rayOrigin;
        const float distance = towards.length();
        if (distance > ball.radius)
            pooled.addOccluderCone(towards / distance, std::asin(ball.radius / distance));
        else
            pooled.addOccluderCone(point.normal, static_cast<float>(kPi));
    }

    /// Fills w.samples, decided before any ray is traced.
    ///
    /// @return the part of the irradiance that needs no ray
    Rgb prepare(const ShadingPoint& point, int samples, CacheWorkspace& w) const {
        if (samples == 0) return preview(point, w);
        w.exchange.addPoint();
        w.shared.clear();
        weigh(point, w);
        if (w.weights.spreadSum() > 0) {
            const double judged = std::min(1.0, kJudgedSamples / samples);
            if (budget_) samples = budget_->samplesOf(predictedNoise(w), point.seed);
            w.weights.shareSurprises(judged * samples, darkest_,
                                     budget_ ? kUnsureShare : kUnsureShareUniform);
            w.sampler.draw(w.weights, samples,
                           w.numbers(context_.sequence, point.seed, 0, 0, samples,
                                     static_cast<std::uint32_t>(samples)),
                           point.seed);
            w.exchange.offer(w.weights);
            for (std::size_t i = 0; i < w.sampler.size(); ++i)
                addSample(point, w.sampler.drawn(i), w);
        }
        const double* predicted = w.weights.predicted();
        return Rgb(static_cast<float>(predicted[0]), static_cast<float>(predicted[1]),
                   static_cast<float>(predicted[2]));
    }

    /// The cosine that the control variate takes for a direction of region `r`.
    float assumedCosine(const ShadingPoint& point, const Region& r, float cosine) const {
        const CellMoments& m = context_.environment.cells(r.level, r.cell / kBlockCells);
        const std::size_t i = r.cell % kBlockCells;
        const float height = point.normal.dot(Vec3f(m.axis[0][i], m.axis[1][i], m.axis[2][i]));
        if (height >= m.sinRadius[i]) return cosine;
        return HorizonFit(height, m.sinRadius[i])(cosine);
    }

    void addSample(const ShadingPoint& point, const RegionSampler::Drawn& drawn,
                   CacheWorkspace& w) const {
        const Region& r = drawn.region;
        const EnvironmentSample& s = drawn.light;
        const float cosine = s.direction.dot(point.normal);
        const Rgb light = s.radiance * (static_cast<float>(drawn.share) / s.density);
        const float assumed = r.visibility * assumedCosine(point, r, cosine);
        if (r.shared != 0 && cosine > 0)
            addShared(r, s, w);
        else if (r.shared == 0 && cosine > 0)
            w.samples.add(s.direction, light * (cosine - assumed), light * -assumed);
        else if (r.shared == 0)
            w.samples.add(Vec3f(0, 0, 0), light * -assumed, light * -assumed);
        if (drawn.endsGroup) w.samples.endGroup();
    }

    /// A sample whose contribution is zero unless it is a surprise, and then shared.
    void addShared(const Region& r, const EnvironmentSample& s, CacheWorkspace& w) const {
        const double luminance = context_.environment.luminanceIntegral(r.level, r.cell);
        w.shared.push_back(
            {w.samples.size(),
             {s.direction, s.radiance, s.cell, static_cast<double>(s.density) * luminance,
              w.exchange.lastPoint(), r.shared > 0}});
        w.samples.add(s.direction, Rgb(0, 0, 0));
    }
};

}  // namespace

std::unique_ptr<Estimator> makeCache(const EstimatorContext& context, const CacheOptions& options) {
    return std::make_unique<CacheEstimator>(context, options);
}

}  // namespace shadowcache
