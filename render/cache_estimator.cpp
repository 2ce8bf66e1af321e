// The cache as a control variate: what the counts predict is integrated exactly over the regions,
// and rays are spent on the difference, where the counts are least sure. The mathematics:
// docs/estimator.md.

#include <algorithm>
#include <cmath>

#include "common/sequence.h"
#include "render/estimators.h"
#include "render/region_weights.h"

namespace shadowcache {

namespace {

/// Regions due this many samples or more get a whole number of strata of their own.
constexpr double kOwnStrata = 1.5;

constexpr double kBelowOne = 0x1.fffffffffffffp-1;

/// A region that samples are drawn from.
struct Region {
    int level;
    std::uint32_t cell;
    float visibility;  ///< c: the control variate's coefficient
    double spread;     ///< predicted standard deviation of one sample: the weight of the region
};

struct CacheWorkspace final : Workspace {
    CacheWorkspace(const ShadowCache& cache, const Environment& environment)
        : reader(cache),
          pooled(cache.header().tiers()),
          weights(environment, cache.header().tiers()),
          items(ShadowCache::kMaxItems) {}

    ShadowCache::Reader reader;
    PooledVisibility pooled;
    RegionWeights weights;
    std::vector<ItemView> items;
    std::vector<Region> own;  ///< regions with strata of their own
};

class CacheEstimator final : public Estimator {
    using Estimator::Estimator;

public:
    std::unique_ptr<Workspace> makeWorkspace() const override {
        return std::make_unique<CacheWorkspace>(*context_.cache, context_.environment);
    }

private:
    Rgb prepare(const ShadingPoint& point, int samples, Workspace& workspace) const override {
        auto& w = static_cast<CacheWorkspace&>(workspace);
        const int found = w.reader.gather(point.position, point.normal, w.items);
        w.pooled.pool(std::span(w.items).first(static_cast<std::size_t>(found)));
        w.weights.weigh(w.pooled, point.normal);
        if (samples > 0 && w.weights.spreadSum() > 0) drawSamples(point, samples, w);
        const double* predicted = w.weights.predicted();
        return Rgb(static_cast<float>(predicted[0]), static_cast<float>(predicted[1]),
                   static_cast<float>(predicted[2]));
    }

    /// Shares the samples out: regions due many get strata of their own, the rest share a few.
    /// Decided by the weights alone.
    void drawSamples(const ShadingPoint& point, int samples, CacheWorkspace& w) const {
        const double total = w.weights.spreadSum();
        const double ownTotal = takeOwnRegions(total * kOwnStrata / samples, w);
        const double restTotal = std::max(0.0, total - ownTotal);
        // What rounding leaves of the difference is no region.
        const bool anyRest = restTotal > 1e-6 * total;
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
                if (spread[i] < threshold) continue;
                w.own.push_back({group.level, group.firstCell + static_cast<std::uint32_t>(i),
                                 w.weights.visibility(g)[i], static_cast<double>(spread[i])});
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
                                   w.weights.visibility(g)[i], s};
                    addSample(point, r, std::clamp((x - below) / s, 0.0, kBelowOne),
                              total / (s * count), numbers.used, w);
                    if (++j < count) x = total * (j + numbers.next()) / count;
                }
                below += s;
            }
        }
        w.samples.endGroup();
    }

    static double groupSum(CacheWorkspace& w, std::size_t g) {
        const float* spread = w.weights.spread(g);
        double sum = 0;
        for (int i = 0; i < kBlockCells; ++i) sum += static_cast<double>(spread[i]);
        return sum;
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
        if (cosine <= 0) {
            w.samples.addZero();
            return;
        }
        const Rgb light = s.radiance * (cosine * static_cast<float>(share) / s.density);
        w.samples.add(s.direction, light * (1 - r.visibility), light * -r.visibility);
    }
};

}  // namespace

std::unique_ptr<Estimator> makeCache(const EstimatorContext& context) {
    return std::make_unique<CacheEstimator>(context);
}

}  // namespace shadowcache
