// The cache as a control variate: what the counts predict is integrated exactly over the regions,
// and rays are spent on the difference, where the counts are least sure. The mathematics:
// docs/estimator.md.

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/parallel.h"
#include "common/sequence.h"
#include "render/estimators.h"
#include "render/horizon.h"
#include "render/region_weights.h"
#include "render/sample_budget.h"
#include "render/surprise_exchange.h"

namespace shadowcache {

namespace {

/// Regions due this many samples or more get a whole number of strata of their own.
constexpr double kOwnStrata = 1.5;

/// Irradiance, as a share of the frame's mean, below which errors count no more.
constexpr double kDarkest = 0.1;

constexpr double kBelowOne = 0x1.fffffffffffffp-1;

/// Rays of the survey at each of its places.
constexpr int kSurveyRays = 64;
constexpr std::size_t kSurveyChunk = 32;

/// A region that samples are drawn from.
struct Region {
    int level;
    std::uint32_t cell;
    float visibility;  ///< c: the control variate's coefficient
    double spread;     ///< predicted standard deviation of one sample: the weight of the region
    float shared;      ///< RegionWeights::shared()
};

/// A region as the survey sees it.
struct SurveyRegion {
    int level;
    std::uint32_t cell;
    float posterior;
    float weight[2];  ///< predicted standard deviation of a sample; light
};

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
          items(ShadowCache::kMaxItems),
          exchange(cache.header().tiers()) {}

    ShadowCache::Reader reader;
    PooledVisibility pooled;
    RegionWeights weights;
    std::vector<ItemView> items;
    std::vector<Region> own;  ///< regions with strata of their own
    std::vector<SurveyRegion> survey;
    std::vector<float> surveyed;  ///< posterior of the region of each ray
    SurpriseExchange exchange;
    std::vector<SharedSample> shared;
};

class CacheEstimator final : public Estimator {
    using Estimator::Estimator;

public:
    std::unique_ptr<Workspace> makeWorkspace() const override {
        return std::make_unique<CacheWorkspace>(*context_.cache, context_.environment);
    }

    std::uint64_t survey(std::span<const ShadingPoint> points, int samples) override {
        reliability_ = Reliability();
        std::vector<Reliability> found((points.size() + kSurveyChunk - 1) / kSurveyChunk);
        std::vector<std::uint64_t> rays(found.size());
        parallelFor(points.size(), kSurveyChunk, [&](const Chunk& chunk) {
            const auto workspace = makeWorkspace();
            auto& w = static_cast<CacheWorkspace&>(*workspace);
            for (std::size_t i = chunk.begin; i < chunk.end; ++i)
                rays[chunk.index] += surveyPoint(points[i], w, found[chunk.index]);
        });
        for (const Reliability& part : found) reliability_.add(part);
        reliability_.update();
        measureBrightness(points);
        if (context_.options.adaptive) planBudget(points, samples);
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
        if (samples > 0 && context_.options.adaptive)
            samples = budget_.samplesOf(predictedNoise(w), point.seed);
        if (samples > 0)
            insight.expectedNoise = static_cast<float>(w.weights.spreadSum() / std::sqrt(samples));
        return insight;
    }

private:
    const OpennessMeter openness_{context_.cache->header().tiers()};
    Reliability reliability_;
    SampleBudget budget_;
    double darkest_ = 0;  ///< irradiance below which errors count no more [luminance]

    void measureBrightness(std::span<const ShadingPoint> points) {
        std::vector<double> sums((points.size() + kSurveyChunk - 1) / kSurveyChunk);
        parallelFor(points.size(), kSurveyChunk, [&](const Chunk& chunk) {
            const auto workspace = makeWorkspace();
            auto& w = static_cast<CacheWorkspace&>(*workspace);
            for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
                weigh(points[i], w);
                sums[chunk.index] += predictedNoise(w).value;
            }
        });
        const double sum = std::accumulate(sums.begin(), sums.end(), 0.0);
        darkest_ = points.empty() ? 0 : kDarkest * sum / static_cast<double>(points.size());
    }

    void planBudget(std::span<const ShadingPoint> points, int samples) {
        std::vector<PredictedNoise> noise(points.size());
        parallelFor(points.size(), kSurveyChunk, [&](const Chunk& chunk) {
            const auto workspace = makeWorkspace();
            auto& w = static_cast<CacheWorkspace&>(*workspace);
            for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
                weigh(points[i], w);
                noise[i] = predictedNoise(w);
            }
        });
        budget_.plan(noise, samples);
    }

    PredictedNoise predictedNoise(const CacheWorkspace& w) const {
        const double* p = w.weights.predicted();
        const Rgb& weights = context_.environment.luminanceWeights();
        return {w.weights.spreadSum(), static_cast<double>(weights.x) * p[0] +
                                           static_cast<double>(weights.y) * p[1] +
                                           static_cast<double>(weights.z) * p[2]};
    }

    /// @return number of items found
    int weigh(const ShadingPoint& point, CacheWorkspace& w) const {
        const int found = w.reader.gather(point.position, point.normal, w.items);
        w.pooled.pool(std::span(w.items).first(static_cast<std::size_t>(found)));
        w.weights.weigh(w.pooled, point.normal, reliability_);
        return found;
    }

    /// Compares the counts with a few rays, half of them where the counts are unsure and half where
    /// the light is.
    ///
    /// @return number of rays
    std::uint64_t surveyPoint(const ShadingPoint& point, CacheWorkspace& w,
                              Reliability& found) const {
        weigh(point, w);
        std::vector<SurveyRegion>& regions = w.survey;
        regions.clear();
        double sums[2] = {0, 0};
        for (std::size_t g = 0; g < w.weights.size(); ++g)
            for (int i = 0; i < kBlockCells; ++i) {
                const float spread = w.weights.spread(g)[i];
                if (!(spread > 0)) continue;
                const RegionGroup& group = w.weights.group(g);
                regions.push_back({group.level,
                                   group.firstCell + static_cast<std::uint32_t>(i),
                                   w.weights.posterior(g)[i],
                                   {spread, w.weights.light(g)[i]}});
                for (int k = 0; k < 2; ++k)
                    sums[k] += static_cast<double>(regions.back().weight[k]);
            }
        w.samples.clear();
        w.surveyed.clear();
        for (int k = 0; k < 2 && sums[k] > 0; ++k) drawSurvey(point, k, sums[k], w);
        Estimate unused;
        w.samples.trace(context_.scene, point, context_.environment, unused);
        for (std::size_t i = 0; i < w.samples.size(); ++i)
            found.add(w.surveyed[i], w.samples.open(i));
        return unused.rays;
    }

    /// Queues half a place's rays of the survey, in proportion to weight[k] of the regions.
    void drawSurvey(const ShadingPoint& point, int k, double sum, CacheWorkspace& w) const {
        constexpr int kRays = kSurveyRays / 2;
        double below = 0;
        int j = 0;
        const auto numberOf = [&](int dimension) {
            return hashWords(point.seed, 81,
                             static_cast<std::uint64_t>(j) * 8 + static_cast<std::uint64_t>(k) * 4 +
                                 static_cast<std::uint64_t>(dimension));
        };
        for (const SurveyRegion& r : w.survey) {
            below += static_cast<double>(r.weight[k]);
            for (; j < kRays && sum * (j + toUnit(numberOf(0))) / kRays < below; ++j) {
                const std::uint64_t h = numberOf(1);
                const EnvironmentSample s = context_.environment.sampleCell(
                    r.level, r.cell, toUnit(numberOf(2)),
                    toUnitFloat(static_cast<std::uint32_t>(h)),
                    toUnitFloat(static_cast<std::uint32_t>(h >> 32)));
                if (s.direction.dot(point.normal) <= 0) continue;
                w.samples.add(s.direction, Rgb(0, 0, 0));
                w.surveyed.push_back(r.posterior);
            }
        }
    }

    Rgb prepare(const ShadingPoint& point, int samples, Workspace& workspace) const override {
        auto& w = static_cast<CacheWorkspace&>(workspace);
        weigh(point, w);
        w.exchange.addPoint();
        w.shared.clear();
        if (samples > 0 && w.weights.spreadSum() > 0) {
            if (context_.options.adaptive)
                samples = budget_.samplesOf(predictedNoise(w), point.seed);
            w.weights.shareSurprises(samples, darkest_);
            drawSamples(point, samples, w);
        }
        const double* predicted = w.weights.predicted();
        return Rgb(static_cast<float>(predicted[0]), static_cast<float>(predicted[1]),
                   static_cast<float>(predicted[2]));
    }

    void takeNote(Workspace& workspace) const override {
        auto& w = static_cast<CacheWorkspace&>(workspace);
        for (const SharedSample& s : w.shared)
            if (w.samples.open(s.index) == s.surprise.open) w.exchange.add(s.surprise);
    }

    void exchange(std::span<const ShadingPoint> points, Workspace& workspace,
                  std::span<Estimate> estimates) const override {
        auto& w = static_cast<CacheWorkspace&>(workspace);
        w.exchange.exchange(context_.scene, context_.environment, points, estimates);
        w.exchange.clear();
    }

    /// Shares the samples out: regions due many get strata of their own, the rest share a few.
    /// Decided by the weights alone.
    void drawSamples(const ShadingPoint& point, int samples, CacheWorkspace& w) const {
        const double total = w.weights.spreadSum();
        const double ownTotal = takeOwnRegions(total * kOwnStrata / samples, w);
        double restTotal = 0;
        for (std::size_t g = 0; g < w.weights.size(); ++g) restTotal += groupSum(w, g);
        const bool anyRest = restTotal > 0;
        const int rest =
            anyRest ? std::max(1, static_cast<int>(std::ceil(restTotal / total * samples))) : 0;
        const double perSpread = ownTotal > 0 ? (samples - rest) / ownTotal : 0;
        Numbers numbers{w.numbers(context_.options.sequence, point.seed, 0, samples), point.seed};
        if (w.own.empty() || perSpread * total * kOwnStrata / samples < 1) {
            // Too few samples for strata of one region: all regions share them.
            returnOwnRegions(w);
            drawRest(point, samples, numbers, w);
            return;
        }
        double sum = 0;
        for (const Region& r : w.own) {
            const int before = static_cast<int>(sum + 1e-6);
            sum += r.spread * perSpread;
            const int count = static_cast<int>(sum + 1e-6) - before;
            for (int j = 0; j < count; ++j)
                addSample(point, r, (j + numbers.next()) / count, 1.0 / count, numbers.used, w);
            w.samples.endGroup();
        }
        if (anyRest) drawRest(point, rest, numbers, w);
    }

    /// Moves the regions whose spread is at least `least` from the groups to w.own.
    ///
    /// @return the sum of their spreads
    static double takeOwnRegions(double least, CacheWorkspace& w) {
        w.own.clear();
        double sum = 0;
        const auto threshold = static_cast<float>(least);
        for (std::size_t g = 0; g < w.weights.size(); ++g) {
            const RegionGroup& group = w.weights.group(g);
            if (group.spreadMax < threshold) continue;
            float* spread = w.weights.spread(g);
            for (int i = 0; i < kBlockCells; ++i) {
                if (spread[i] < threshold || w.weights.shared(g)[i] != 0) continue;
                w.own.push_back({group.level, group.firstCell + static_cast<std::uint32_t>(i),
                                 w.weights.visibility(g)[i], static_cast<double>(spread[i]), 0});
                sum += static_cast<double>(spread[i]);
                spread[i] = 0;
            }
        }
        return sum;
    }

    static void returnOwnRegions(CacheWorkspace& w) {
        std::size_t next = 0;
        for (std::size_t g = 0; g < w.weights.size() && next < w.own.size(); ++g) {
            const RegionGroup& group = w.weights.group(g);
            while (next < w.own.size() && w.own[next].level == group.level &&
                   w.own[next].cell / kBlockCells == group.firstCell / kBlockCells) {
                w.weights.spread(g)[w.own[next].cell % kBlockCells] =
                    static_cast<float>(w.own[next].spread);
                ++next;
            }
        }
    }

    /// One number for each sample, in order.
    struct Numbers {
        std::span<const std::uint32_t> words;
        std::uint64_t seed;
        int used = 0;

        /// In [0, 1), 53 bits.
        double next() {
            const auto k = static_cast<std::size_t>(used++);
            const auto low = toUnit(hashWords(seed, 79, k));
            return (static_cast<double>(words[std::min(k, words.size() - 1)]) + low) * 0x1p-32;
        }
    };

    /// Draws `count` samples from the regions in the groups, stratified over all of them.
    void drawRest(const ShadingPoint& point, int count, Numbers& numbers, CacheWorkspace& w) const {
        double total = 0;
        for (std::size_t g = 0; g < w.weights.size(); ++g) total += groupSum(w, g);
        if (!(total > 0)) return;
        double below = 0;
        int j = 0;
        double x = total * numbers.next() / count;
        std::size_t last = w.weights.size() - 1;
        while (!(groupSum(w, last) > 0)) --last;
        for (std::size_t g = 0; g <= last && j < count; ++g) {
            const double sum = groupSum(w, g);
            if (x >= below + sum && g < last) {
                below += sum;
                continue;
            }
            const float* spread = w.weights.spread(g);
            int lastLane = kBlockCells - 1;
            while (!(spread[lastLane] > 0)) --lastLane;
            for (int i = 0; i <= lastLane && j < count; ++i) {
                const auto s = static_cast<double>(spread[i]);
                // Rounding may leave the very last x past the end: it is the last region's.
                const bool end = g == last && i == lastLane;
                while (s > 0 && j < count && (x < below + s || end)) {
                    const RegionGroup& group = w.weights.group(g);
                    const Region r{group.level, group.firstCell + static_cast<std::uint32_t>(i),
                                   w.weights.visibility(g)[i], s, w.weights.shared(g)[i]};
                    addSample(point, r, std::clamp((x - below) / s, 0.0, kBelowOne),
                              total / (s * count), numbers.used, w);
                    if (++j < count) x = total * (j + numbers.next()) / count;
                }
                below += s;
            }
        }
        w.samples.endGroup();
        w.exchange.offer(w.weights, count / total);
    }

    static double groupSum(CacheWorkspace& w, std::size_t g) {
        const float* spread = w.weights.spread(g);
        double sum = 0;
        for (int i = 0; i < kBlockCells; ++i) sum += static_cast<double>(spread[i]);
        return sum;
    }

    /// The cosine that the control variate takes for a direction of region `r`.
    float assumedCosine(const ShadingPoint& point, const Region& r, float cosine) const {
        const CellMoments& m = context_.environment.cells(r.level, r.cell / kBlockCells);
        const std::size_t i = r.cell % kBlockCells;
        const float height = point.normal.dot(Vec3f(m.axis[0][i], m.axis[1][i], m.axis[2][i]));
        if (height >= m.sinRadius[i]) return cosine;
        return HorizonFit(height, m.sinRadius[i])(cosine);
    }

    /// One ray into region `r` at place `u` of its light; `share` is 1 / (samples * probability) of
    /// the region.
    void addSample(const ShadingPoint& point, const Region& r, double u, double share, int index,
                   CacheWorkspace& w) const {
        const std::uint64_t h = hashWords(point.seed, 80, static_cast<std::uint64_t>(index));
        const EnvironmentSample s = context_.environment.sampleCell(
            r.level, r.cell, std::min(u, kBelowOne), toUnitFloat(static_cast<std::uint32_t>(h)),
            toUnitFloat(static_cast<std::uint32_t>(h >> 32)));
        const float cosine = s.direction.dot(point.normal);
        if (r.shared != 0) {
            if (cosine > 0) addShared(r, s, w);
            return;
        }
        const Rgb light = s.radiance * (static_cast<float>(share) / s.density);
        const float assumed = r.visibility * assumedCosine(point, r, cosine);
        if (cosine > 0)
            w.samples.add(s.direction, light * (cosine - assumed), light * -assumed);
        else
            w.samples.add(Vec3f(0, 0, 0), light * -assumed, light * -assumed);
    }

    /// A sample whose contribution is zero unless it is a surprise, and then shared.
    void addShared(const Region& r, const EnvironmentSample& s, CacheWorkspace& w) const {
        const double power = context_.environment.power(r.level, r.cell);
        w.shared.push_back(
            {w.samples.size(),
             {s.direction, s.radiance, s.cell, static_cast<double>(s.density) * power,
              w.exchange.lastPoint(), r.shared > 0}});
        w.samples.add(s.direction, Rgb(0, 0, 0));
    }
};

}  // namespace

std::unique_ptr<Estimator> makeCache(const EstimatorContext& context) {
    return std::make_unique<CacheEstimator>(context);
}

}  // namespace shadowcache
