// The cache as a control variate: what the counts predict is integrated exactly over the regions, and rays are
// spent on the difference, where the counts are least sure. The mathematics: docs/estimator.md.

#include <algorithm>
#include <cmath>

#include "common/sequence.h"
#include "render/estimators.h"
#include "render/pooled_visibility.h"

namespace shadowcache {

namespace {

/// How strongly a region's parent counts beside its own rays, in rays.
constexpr float kPriorRays = 0.5f;
/// Regions due this many samples or more get a whole number of strata of their own.
constexpr float kOwnStrata = 1.5f;

/// A region that samples may be drawn from.
struct Region {
    std::uint32_t cell;
    std::uint8_t level;
    float visibility;  ///< c: the control variate's coefficient
    float spread;      ///< predicted standard deviation of one sample: the weight of the region
};

struct CacheWorkspace final : Workspace {
    CacheWorkspace(const ShadowCache& cache)
        : reader(cache), pooled(cache.header().tiers()), items(ShadowCache::kMaxItems) {}

    ShadowCache::Reader reader;
    PooledVisibility pooled;
    std::vector<ItemView> items;
    std::vector<Region> regions;
    double predicted[3] = {0, 0, 0};  ///< sum of c_r (n . V_r)
    double spreadSum = 0;
};

/// What a cell inherits from its parent.
struct Inherited {
    float visibility;
    float posterior;
    bool counted;   ///< whether any ray was counted in the parent
};

class CacheEstimator final : public Estimator {
public:
    explicit CacheEstimator(const EstimatorContext& context)
        : Estimator(context), tiers_(context.cache->header().tiers()) {
        // Horizon cells are split to the finest level that has the parity of the cache's.
        finest_ = Environment::kLevel - (tiers_.baseLevel() == Environment::kLevel % 2 ? 0 : 1);
    }

    std::unique_ptr<Workspace> makeWorkspace() const override {
        return std::make_unique<CacheWorkspace>(*context_.cache);
    }

private:
    DirectionTiers tiers_;
    int finest_;

    Rgb prepare(const ShadingPoint& point, int samples, Workspace& workspace) const override {
        auto& w = static_cast<CacheWorkspace&>(workspace);
        weigh(point, w);
        if (samples > 0 && w.spreadSum > 0) drawSamples(point, samples, w);
        return Rgb(static_cast<float>(w.predicted[0]), static_cast<float>(w.predicted[1]),
                   static_cast<float>(w.predicted[2]));
    }

    /// Lists the regions with their coefficients and weights and sums up the exact part.
    void weigh(const ShadingPoint& point, CacheWorkspace& w) const {
        w.regions.clear();
        w.predicted[0] = w.predicted[1] = w.predicted[2] = 0;
        w.spreadSum = 0;
        const int found = w.reader.gather(point.position, point.normal, w.items);
        w.pooled.pool(std::span(w.items).first(static_cast<std::size_t>(found)));

        double open = 0, rays = 0;
        for (std::uint32_t b = 0; b < w.pooled.baseBlocks(); ++b)
            for (int i = 0; i < kBlockCells; ++i) {
                open += static_cast<double>(w.pooled.base(b).open[i]);
                rays += static_cast<double>(w.pooled.base(b).weight[i]);
            }
        const Inherited root{0, static_cast<float>((open + 0.5) / (rays + 1)), false};
        for (std::uint32_t b = 0; b < w.pooled.baseBlocks(); ++b)
            weighBlock(point, 0, b, &w.pooled.base(b), root, w);
    }

    /// Weighs the sixteen cells of block `block` of the level of `tier`; `counts` is null where no item has
    /// counts that fine.
    void weighBlock(const ShadingPoint& point, int tier, std::uint32_t block,
                    const PooledBlock* counts, const Inherited& parent, CacheWorkspace& w) const {
        const int level = tiers_.baseLevel() + 2 * tier;
        const CellMoments& m = context_.environment.cells(level, block);
        const Rgb& y = context_.environment.luminanceWeights();
        const Vec3f n = point.normal;
        alignas(64) float height[kBlockCells], light[kBlockCells], c[kBlockCells], a[kBlockCells],
            spread[kBlockCells], flux[3][kBlockCells];
        for (int i = 0; i < kBlockCells; ++i) {
            height[i] = n.x * m.axis[0][i] + n.y * m.axis[1][i] + n.z * m.axis[2][i];
            for (int k = 0; k < 3; ++k)
                flux[k][i] = n.x * m.flux[k][0][i] + n.y * m.flux[k][1][i] + n.z * m.flux[k][2][i];
            light[i] = y.x * flux[0][i] + y.y * flux[1][i] + y.z * flux[2][i];
        }
        if (counts) {
            for (int i = 0; i < kBlockCells; ++i) {
                const bool counted = counts->weight[i] > 0;
                const float effective =
                    counts->rays[i] * counts->rays[i] / std::max(counts->rays2[i], 1e-30f);
                const float ratio = counts->open[i] / std::max(counts->weight[i], 1e-30f);
                c[i] = counted ? std::min(ratio, 1.0f) : 0.0f;
                a[i] = (c[i] * effective + kPriorRays * parent.posterior) / (effective + kPriorRays);
            }
        } else {
            for (int i = 0; i < kBlockCells; ++i) {
                c[i] = parent.visibility;
                a[i] = parent.posterior;
            }
        }
        for (int i = 0; i < kBlockCells; ++i) {
            const float second = a[i] * (1 - c[i]) * (1 - c[i]) + (1 - a[i]) * c[i] * c[i];
            spread[i] = light[i] * std::sqrt(second);
        }
        for (int i = 0; i < kBlockCells; ++i) {
            if (m.power[i] <= 0 || height[i] <= -m.sinRadius[i]) continue;
            const std::uint32_t cell = block * kBlockCells + static_cast<std::uint32_t>(i);
            const bool straddles = height[i] < m.sinRadius[i];
            const bool counted = counts ? counts->weight[i] > 0 : parent.counted;
            if (level < finest_) {
                const PooledBlock* finer =
                    tier < tiers_.refinements() ? w.pooled.children(tier, cell) : nullptr;
                if (finer || straddles) {
                    weighBlock(point, tier + 1, cell, finer, {c[i], a[i], counted}, w);
                    continue;
                }
            }
            if (straddles) {
                // Cut by the horizon: nothing is predicted, but light may come.
                const float most = m.power[i] * std::min(1.0f, height[i] + m.sinRadius[i]);
                addRegion(cell, level, 0, 0.5f * most * std::sqrt(a[i]), w);
                continue;
            }
            for (int k = 0; k < 3; ++k)
                w.predicted[k] += static_cast<double>(c[i]) * static_cast<double>(flux[k][i]);
            addRegion(cell, level, c[i], spread[i], w);
        }
    }

    static void addRegion(std::uint32_t cell, int level, float visibility, float spread,
                          CacheWorkspace& w) {
        if (!(spread > 0)) return;
        w.regions.push_back({cell, static_cast<std::uint8_t>(level), visibility, spread});
        w.spreadSum += static_cast<double>(spread);
    }

    /// Shares the samples out: regions due many get strata of their own, the rest share a few.
    void drawSamples(const ShadingPoint& point, int samples, CacheWorkspace& w) const {
        const auto numbers = w.numbers(context_.options.sequence, point.seed, 0, samples);
        const double due = samples / w.spreadSum;
        double ownDue = 0, restSpread = 0;
        for (const Region& r : w.regions) {
            const double n = static_cast<double>(r.spread) * due;
            if (n >= static_cast<double>(kOwnStrata)) ownDue += n;
            else restSpread += static_cast<double>(r.spread);
        }
        const double restDue = restSpread * due;
        int rest = restSpread > 0 ? std::max(1, static_cast<int>(std::ceil(restDue))) : 0;
        double scale = ownDue > 0 ? (samples - rest) / ownDue : 0;
        // Every region with strata of its own must get one; with few samples none has any.
        const bool own = scale * static_cast<double>(kOwnStrata) >= 1;
        if (!own) {
            rest = samples;
            restSpread = w.spreadSum;
        }
        int next = 0;
        if (own) {
            double sum = 0;
            for (const Region& r : w.regions) {
                const double n = static_cast<double>(r.spread) * due;
                if (n < static_cast<double>(kOwnStrata)) continue;
                const int before = static_cast<int>(sum + 1e-6);
                sum += n * scale;
                const int count = static_cast<int>(sum + 1e-6) - before;
                for (int j = 0; j < count; ++j, ++next)
                    addSample(point, r, (j + stratum(point, numbers, next)) / count, 1.0 / count,
                              next, w);
                w.samples.endGroup();
            }
        }
        if (rest > 0) drawRest(point, own, due, rest, restSpread, numbers, next, w);
    }

    void drawRest(const ShadingPoint& point, bool own, double due, int rest, double restSpread,
                  std::span<const std::uint32_t> numbers, int next, CacheWorkspace& w) const {
        double below = 0;
        int j = 0;
        double x = restSpread * stratum(point, numbers, next) / rest;
        for (const Region& r : w.regions) {
            const auto spread = static_cast<double>(r.spread);
            if (own && spread * due >= static_cast<double>(kOwnStrata)) continue;
            while (j < rest && x < below + spread) {
                const double inRegion = std::clamp((x - below) / spread, 0.0, 0x1.fffffffffffffp-1);
                addSample(point, r, inRegion, restSpread / (spread * rest), next + j, w);
                if (++j < rest) x = restSpread * (j + stratum(point, numbers, next + j)) / rest;
            }
            below += spread;
        }
        w.samples.endGroup();
    }

    /// Place within stratum i, in [0, 1).
    double stratum(const ShadingPoint& point, std::span<const std::uint32_t> numbers, int i) const {
        const auto k = std::min(static_cast<std::size_t>(i), numbers.size() - 1);
        return (static_cast<double>(numbers[k]) +
                toUnit(hashWords(point.seed, 79, static_cast<std::uint64_t>(i)))) *
               0x1p-32;
    }

    /// One ray into region `r`; `share` is 1 / (samples * probability) of the region.
    void addSample(const ShadingPoint& point, const Region& r, double u, double share, int index,
                   CacheWorkspace& w) const {
        const std::uint64_t h = hashWords(point.seed, 80, static_cast<std::uint64_t>(index));
        const EnvironmentSample s = context_.environment.sampleCell(
            r.level, r.cell, std::min(u, 0x1.fffffffffffffp-1),
            toUnitFloat(static_cast<std::uint32_t>(h)), toUnitFloat(static_cast<std::uint32_t>(h >> 32)));
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
