// The adaptive dome light [Atanasov et al. 2018]: a pilot learns which tiles of the map are visible
// from where on the film; samples choose a tile by that, then a direction in it by its luminance.

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/base/parallel.h"
#include "common/random/salts.h"
#include "render/estimators/basic_estimators.h"
#include "render/estimators/dome_cells.h"
#include "render/estimators/full_precision.h"
#include "render/estimators/hemisphere.h"
#include "render/estimators/light_tiles.h"

namespace shadowcache {

namespace {

/// Parts of the map.
constexpr std::size_t kTiles = 128;
/// One sample in how many is in proportion to the cosine.
constexpr std::uint32_t kCosinePeriod = 4;
/// Share of the tiles' samples drawn by the light and the cosine only.
constexpr float kDomeDefensiveShare = 0.2f;
/// The pilot's rays at a place, and their share in the frame's samples.
constexpr std::size_t kRaysOfPlace = RayPacket::kSize;
constexpr double kPilotShare = 0.06;
constexpr std::size_t kMostPlaces = 1 << 18;

/// Eight sums at a time, which SIMD registers like.
float sumOf(std::span<const float> x) {
    float lanes[8] = {};
    const std::size_t whole = x.size() / 8 * 8;
    for (std::size_t i = 0; i < whole; i += 8)
        for (std::size_t k = 0; k < 8; ++k) lanes[k] += x[i + k];
    for (std::size_t i = whole; i < x.size(); ++i) lanes[i - whole] += x[i];
    return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) +
           ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
}

/// Probabilities of the tiles at a point.
class TileChoice {
public:
    /// Sets the probabilities in proportion to `weights`.
    ///
    /// @return whether any is positive
    bool set(std::span<const float> weights) {
        begin_.resize(weights.size() + 1);
        double sum = 0;
        for (std::size_t i = 0; i < weights.size(); ++i) {
            begin_[i] = sum;
            sum += static_cast<double>(weights[i]);
        }
        begin_.back() = sum;
        return sum > 0;
    }
    float probability(std::size_t tile) const {
        return static_cast<float>((begin_[tile + 1] - begin_[tile]) / begin_.back());
    }
    /// Tile that u in [0, 1) chooses, one of positive probability; u becomes the place in it.
    std::size_t choose(double& u) const {
        const double x = u * begin_.back();
        const auto end = std::upper_bound(begin_.begin() + 1, begin_.end() - 1, x);
        auto tile = static_cast<std::size_t>(end - begin_.begin()) - 1;
        while (tile > 0 && !(begin_[tile + 1] > begin_[tile])) --tile;
        while (!(begin_[tile + 1] > begin_[tile])) ++tile;
        u = std::clamp((x - begin_[tile]) / (begin_[tile + 1] - begin_[tile]), 0.0, 1 - 0x1p-53);
        return tile;
    }

private:
    std::vector<double> begin_;
};

struct DomeWorkspace final : Workspace {
    const DomeCells* cells = nullptr;  ///< of the frame; null without a pilot
    std::vector<float> cosines, weights;
    TileChoice choice;
};

/// What a pilot learned of a frame.
struct DomePlan final : EstimatorPlan {
    DomePlan(std::span<const ShadingPoint> points, std::span<const TileRay> traced,
             std::span<const std::uint8_t> counts, std::size_t tiles)
        : cells(points, traced, counts, kRaysOfPlace, tiles) {
        for (const std::uint8_t count : counts) rays += count;
    }

    DomeCells cells;
};

/// Learns the cells of a frame.
class DomePilot final : public FramePilot {
public:
    DomePilot(const EstimatorContext& context, const LightTiles& tiles)
        : context_(context), tiles_(tiles) {}

    std::size_t places(std::uint64_t samples) const override {
        const double wanted = kPilotShare * static_cast<double>(samples) / kRaysOfPlace;
        return static_cast<std::size_t>(std::clamp(wanted,
                                                   static_cast<double>(FramePilot::places(samples)),
                                                   static_cast<double>(kMostPlaces)));
    }

    std::unique_ptr<const EstimatorPlan> plan(std::span<const ShadingPoint> points, int,
                                              double) const override {
        std::vector<TileRay> rays(points.size() * kRaysOfPlace);
        std::vector<std::uint8_t> counts(points.size(), 0);
        parallelFor(points.size(), 64, [&](const Chunk& chunk) {
            DomeWorkspace w;
            for (std::size_t i = chunk.begin; i < chunk.end; ++i)
                counts[i] = trace(points[i], w, &rays[i * kRaysOfPlace]);
        });
        return std::make_unique<DomePlan>(points, rays, counts, tiles_.size());
    }

private:
    /// Sends rays to the tiles, more of them to bright ones and to those above.
    ///
    /// @return number of rays in `out`
    std::uint8_t trace(const ShadingPoint& point, DomeWorkspace& w, TileRay* out) const {
        w.samples.clear();
        w.cosines.resize(tiles_.size());
        tiles_.cosines(point.place.normal, w.cosines);
        for (std::size_t t = 0; t < tiles_.size(); ++t)
            w.cosines[t] *= std::sqrt(tiles_.light()[t]);
        if (!w.choice.set(w.cosines)) return 0;
        std::uint8_t count = 0;
        for (std::size_t j = 0; j < kRaysOfPlace; ++j) {
            double u = (static_cast<double>(j) +
                        toUnit(hashWords(point.slot.seed, RenderSalt::domePilotTile, j))) /
                       kRaysOfPlace;
            const std::size_t tile = w.choice.choose(u);
            const std::uint64_t h = hashWords(point.slot.seed, RenderSalt::domePilotTexel, j);
            const Vec3f direction =
                context_.environment
                    .sampleCell(tiles_[tile].level, tiles_[tile].cell, u,
                                toUnitFloat(static_cast<std::uint32_t>(h)),
                                toUnitFloat(static_cast<std::uint32_t>(h >> 32)))
                    .direction;
            if (direction.dot(point.place.normal) <= 0) continue;
            w.samples.add(direction, Rgb(0, 0, 0));
            out[count++].tile = static_cast<std::uint8_t>(tile);
        }
        Estimate unused;
        w.samples.trace(context_.scene, point.place, context_.environment, unused);
        for (std::size_t k = 0; k < count; ++k) out[k].visible = w.samples.visible(k);
        return count;
    }

    const EstimatorContext& context_;
    const LightTiles& tiles_;
};

class Dome final : public PointEstimator {
public:
    explicit Dome(const EstimatorContext& context)
        : PointEstimator(context),
          tiles_(context.environment, kTiles),
          pilot_(context_, tiles_),
          mapShare_(tiles_.size()) {
        for (std::size_t t = 0; t < tiles_.size(); ++t)
            mapShare_[t] = static_cast<float>(static_cast<double>(tiles_.light()[t]) /
                                              context.environment.luminanceIntegral());
    }

    std::unique_ptr<Workspace> makeWorkspace() const override {
        return std::make_unique<DomeWorkspace>();
    }
    const FramePilot* pilot() const override { return &pilot_; }

    using PointEstimator::estimate;
    void estimate(const PointBatch& batch, Workspace& workspace,
                  std::span<Estimate> estimates) const override {
        static_cast<DomeWorkspace&>(workspace).cells =
            batch.plan ? &static_cast<const DomePlan&>(*batch.plan).cells : nullptr;
        PointEstimator::estimate(batch, workspace, estimates);
    }

private:
    /// The samples of a pixel take turns: one in kCosinePeriod is in proportion to the cosine, the
    /// others to the map. Chance decides which is the first, so that every one of them, whatever
    /// its number, is as likely of the one kind as any other.
    Rgb prepare(const ShadingPoint& point, const SampleSlice& slice,
                Workspace& workspace) const override {
        if (context_.environment.luminanceIntegral() <= 0) return {0, 0, 0};
        auto& w = static_cast<DomeWorkspace&>(workspace);
        const bool anyTile = chooseTiles(point, w);
        const auto turn = static_cast<std::uint32_t>(
            toUnit(hashWords(point.slot.seed, RenderSalt::domeTurn)) * kCosinePeriod);
        const auto cosinesBefore = [turn](std::uint32_t i) {
            return (i + turn + kCosinePeriod - 1) / kCosinePeriod -
                   (turn + kCosinePeriod - 1) / kCosinePeriod;
        };
        const std::uint32_t end = slice.first + static_cast<std::uint32_t>(slice.count);
        const std::uint32_t firstCosine = cosinesBefore(slice.first);
        const auto cosines = static_cast<int>(cosinesBefore(end) - firstCosine);
        addCosineSamples(point, {firstCosine, cosines}, slice.count, anyTile, w);
        if (anyTile)
            addTileSamples(point, {slice.first - firstCosine, slice.count - cosines}, slice.count,
                           w);
        return {0, 0, 0};
    }

    /// Sets w.choice to light * cosine * sqrt(visibility), which is the best for a tile whose rays
    /// are visible with that chance; the defensive share to light * cosine.
    bool chooseTiles(const ShadingPoint& point, DomeWorkspace& w) const {
        const std::size_t count = tiles_.size();
        w.cosines.resize(count);
        w.weights.resize(count);
        tiles_.cosines(point.place.normal, w.cosines);
        float* plain = w.cosines.data();
        float* learned = w.weights.data();
        const float* light = tiles_.light().data();
        for (std::size_t t = 0; t < count; ++t) plain[t] *= light[t];
        if (!w.cells) return w.choice.set(w.cosines);
        const float* visibility = w.cells->visibility(point).data();
        for (std::size_t t = 0; t < count; ++t) learned[t] = plain[t] * std::sqrt(visibility[t]);
        const float learnedSum = sumOf(w.weights);
        if (!(learnedSum > 0)) return w.choice.set(w.cosines);
        const float plainFactor = kDomeDefensiveShare / sumOf(w.cosines);
        const float learnedFactor = (1 - kDomeDefensiveShare) / learnedSum;
        for (std::size_t t = 0; t < count; ++t)
            learned[t] = learned[t] * learnedFactor + plain[t] * plainFactor;
        return w.choice.set(w.weights);
    }

    void addTileSamples(const ShadingPoint& point, const SampleSlice& slice, int samples,
                        DomeWorkspace& w) const {
        const auto u = w.numbers(context_.sequence, point.slot.seed, 0, slice.first, slice.count);
        const auto v = w.numbers(context_.sequence, point.slot.seed, 1, slice.first, slice.count);
        for (std::size_t k = 0; k < u.size(); ++k) {
            const std::uint64_t number = slice.first + k;
            double place = fullPrecision(u[k], point.slot.seed, number);
            const std::size_t tile = w.choice.choose(place);
            const auto jitter = static_cast<std::uint32_t>(
                hashWords(point.slot.seed, RenderSalt::domeTexel, number) >> 32);
            const EnvironmentSample s =
                context_.environment.sampleCell(tiles_[tile].level, tiles_[tile].cell, place,
                                                toUnitFloat(v[k]), toUnitFloat(jitter));
            const float cosine = s.direction.dot(point.place.normal);
            if (cosine > 0)
                w.samples.add(s.direction,
                              s.radiance * (cosine / density(w.choice.probability(tile) * s.density,
                                                             cosine, samples)));
            else
                w.samples.addZero();
        }
        w.samples.endGroup();
    }

    void addCosineSamples(const ShadingPoint& point, const SampleSlice& slice, int samples,
                          bool anyTile, DomeWorkspace& w) const {
        const auto a = w.numbers(context_.sequence, point.slot.seed, 2, slice.first, slice.count);
        const auto b = w.numbers(context_.sequence, point.slot.seed, 3, slice.first, slice.count);
        for (std::size_t i = 0; i < a.size(); ++i) {
            const float cosine = std::sqrt(1 - toUnitFloat(a[i]));
            const Vec3f direction = aroundNormal(point.place.normal, cosine, toUnitFloat(b[i]));
            const EnvironmentSample s = context_.environment.lookUp(direction);
            float ofTiles = 0;
            if (anyTile && s.density > 0) {
                const std::size_t tile = tiles_.tileOf(s.cell);
                ofTiles = w.choice.probability(tile) * (s.density / mapShare_[tile]);
            }
            w.samples.add(direction, s.radiance * (cosine / density(ofTiles, cosine, samples)));
        }
        w.samples.endGroup();
    }

    /// Of `samples` samples together.
    static float density(float ofTiles, float cosine, int samples) {
        const float cosineShare = 1.0f / static_cast<float>(kCosinePeriod);
        return static_cast<float>(samples) *
               ((1 - cosineShare) * ofTiles + cosineShare * cosine / static_cast<float>(kPi));
    }

    const LightTiles tiles_;
    DomePilot pilot_;
    std::vector<float> mapShare_;  ///< of each tile in the light of the map
};

}  // namespace

std::unique_ptr<Estimator> makeDome(const EstimatorContext& context) {
    return std::make_unique<Dome>(context);
}

}  // namespace shadowcache
