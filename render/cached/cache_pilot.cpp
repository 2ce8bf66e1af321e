#include "render/cached/cache_pilot.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "common/base/parallel.h"
#include "common/base/tuned.h"
#include "common/random/salts.h"
#include "common/random/sequence.h"
#include "render/cached/place_lookup.h"
#include "render/regions/cosine_integrand.h"

namespace shadowcache {

namespace {

/// Rays at each place.
SHADOWCACHE_TUNED(int, kPilotRays, 64);

/// Irradiance, as a share of the frame's mean, below which errors count no more.
SHADOWCACHE_TUNED(double, kDarkest, 0.1);

/// Irradiance, as a share of the frame's mean, below which errors are absolute, as relMSE has it.
constexpr double kFloor = 0.1;

/// Places that one thread takes at a time.
constexpr std::size_t kPilotChunk = 32;

/// The regions of a place, split as far as they can be, and not at all.
struct PilotPlace {
    std::vector<RegionEvidence> fine, coarse;
};

/// Looks at one place after another. Arrays are used again; one object a thread.
class PilotLook {
public:
    explicit PilotLook(const EstimatorContext& context)
        : context_(context),
          lookup_(*context.cache),
          splitter_(context.environment, context.cache->header().tiers()),
          builder_(context.environment, context.cache->header().tiers()) {}

    /// Sets the regions of a place, and adds to `found` rays from there beside what the counts
    /// predict.
    ///
    /// @return number of rays
    std::uint64_t look(const ShadingPoint& point, PilotPlace& place, Calibration& found);

private:
    struct Region {
        int level;
        std::uint32_t cell;
        float posterior;
        float weight[2];  ///< predicted standard deviation of a sample; light
    };

    const Regions& build(const ShadingPoint& point, float leastNoise);
    std::uint64_t trace(const ShadingPoint& point, const Regions& regions, Calibration& found);
    void draw(const ShadingPoint& point, int k, double sum);

    const EstimatorContext& context_;
    PlaceLookup lookup_;
    CellSplitter splitter_;
    RegionBuilder<CosineIntegrand> builder_;
    const Calibration uncalibrated_;
    LightSamples samples_;
    std::vector<Region> regions_;
    std::vector<float> posteriors_;  ///< of the region of each ray
};

/// The regions of a place, calibrated.
const Regions& calibrate(std::span<const RegionEvidence> place, const Calibration& calibration,
                         Regions& regions) {
    regions.clear();
    for (const RegionEvidence& evidence : place) regions.add(evidence, calibration);
    return regions;
}

const Regions& PilotLook::build(const ShadingPoint& point, float leastNoise) {
    const CosineIntegrand cosine(context_.environment, splitter_, point.place.normal, 0,
                                 leastNoise);
    return builder_.build(cosine, lookup_.pooled(), uncalibrated_).regions;
}

std::uint64_t PilotLook::look(const ShadingPoint& point, PilotPlace& place, Calibration& found) {
    lookup_.pool(context_.scene, point.place, 0);
    const std::uint64_t rays = trace(point, build(point, 0), found);
    place.fine.assign(builder_.evidence().begin(), builder_.evidence().end());
    build(point, std::numeric_limits<float>::max());
    place.coarse.assign(builder_.evidence().begin(), builder_.evidence().end());
    return rays;
}

std::uint64_t PilotLook::trace(const ShadingPoint& point, const Regions& regions,
                               Calibration& found) {
    regions_.clear();
    double sums[2] = {0, 0};
    for (std::size_t g = 0; g < regions.groups.size(); ++g)
        for (std::uint32_t i = 0; i < kBlockCells; ++i) {
            const RegionGroup& group = regions.groups[g];
            if (!(group.deviation[i] > 0)) continue;
            regions_.push_back({group.level,
                                group.firstCell + i,
                                builder_.evidence()[g].posterior[i],
                                {group.deviation[i], group.light[i]}});
            for (int k = 0; k < 2; ++k) sums[k] += static_cast<double>(regions_.back().weight[k]);
        }
    samples_.clear();
    posteriors_.clear();
    for (int k = 0; k < 2 && sums[k] > 0; ++k) draw(point, k, sums[k]);
    Estimate unused;
    samples_.trace(context_.scene, point.place, context_.environment, unused);
    for (std::size_t i = 0; i < samples_.size(); ++i)
        found.add(posteriors_[i], samples_.visible(i));
    return unused.rays;
}

/// Queues half of the rays, in proportion to weight[k] of the regions.
void PilotLook::draw(const ShadingPoint& point, int k, double sum) {
    const int each = kPilotRays / 2;
    int j = 0;
    const auto numberOf = [&](int dimension) {
        return hashWords(point.slot.seed, RenderSalt::pilotRay,
                         static_cast<std::uint64_t>(j) * 8 + static_cast<std::uint64_t>(k) * 4 +
                             static_cast<std::uint64_t>(dimension));
    };
    const auto placeOf = [&] { return sum * (j + toUnit(numberOf(0))) / each; };
    double below = 0, next = placeOf();
    for (const Region& r : regions_) {
        below += static_cast<double>(r.weight[k]);
        for (; j < each && next < below; ++j, next = placeOf()) {
            const std::uint64_t h = numberOf(1);
            const EnvironmentSample s = context_.environment.sampleCell(
                r.level, r.cell, toUnit(numberOf(2)), toUnitFloat(static_cast<std::uint32_t>(h)),
                toUnitFloat(static_cast<std::uint32_t>(h >> 32)));
            if (s.direction.dot(point.place.normal) <= 0) continue;
            samples_.add(s.direction, Rgb(0, 0, 0));
            posteriors_.push_back(r.posterior);
        }
    }
}

/// What the cache predicts of a place: its irradiance, the standard deviation of a sample, and the
/// sums of what its regions deviate.
struct Prediction {
    double luminance = 0, deviation = 0, fine = 0, coarse = 0;
};

/// Means over the places.
void planByMeans(std::span<const Prediction> predicted, CachePlan& plan) {
    double brightness = 0, fine = 0, coarse = 0;
    for (const Prediction& p : predicted) {
        const double part = 1 / static_cast<double>(predicted.size());
        brightness += part * p.luminance;
        fine += part * p.fine;
        coarse += part * p.coarse;
    }
    plan.splitNoise = splitNoise(fine, coarse);
    plan.darkest = kDarkest * brightness;
    plan.floor = std::max(kFloor * brightness, 1e-15);
}

/// Calls `use(number, regions)` for each place, and a chunk's number.
template <class Use>
void forEachPlace(std::span<const PilotPlace> places, const Calibration& calibration,
                  const Use& use) {
    parallelFor(places.size(), kPilotChunk, [&](const Chunk& chunk) {
        Regions regions;
        for (std::size_t i = chunk.begin; i < chunk.end; ++i)
            use(i, chunk.index, calibrate(places[i].fine, calibration, regions));
    });
}

}  // namespace

std::unique_ptr<const CachePlan> planByCache(const EstimatorContext& context, bool adaptive,
                                             std::span<const ShadingPoint> points, int samples,
                                             double cameraRayError) {
    auto result = std::make_unique<CachePlan>();
    CachePlan& plan = *result;
    std::vector<PilotPlace> places(points.size());
    std::vector<Calibration> found((points.size() + kPilotChunk - 1) / kPilotChunk);
    std::vector<std::uint64_t> rays(found.size());
    parallelFor(points.size(), kPilotChunk, [&](const Chunk& chunk) {
        PilotLook look(context);
        for (std::size_t i = chunk.begin; i < chunk.end; ++i)
            rays[chunk.index] += look.look(points[i], places[i], found[chunk.index]);
    });
    for (const Calibration& part : found) plan.calibration.add(part);
    for (const std::uint64_t some : rays) plan.rays += some;
    plan.calibration.update();

    std::vector<Prediction> predicted(points.size());
    forEachPlace(places, plan.calibration, [&](std::size_t i, std::size_t, const Regions& fine) {
        Regions coarse;
        predicted[i] = {fine.predictedLuminance, deviationOf(fine), fine.deviationSum,
                        calibrate(places[i].coarse, plan.calibration, coarse).deviationSum};
    });
    planByMeans(predicted, plan);
    std::vector<PredictedNoise> noise;
    for (std::size_t i = 0; i < points.size(); ++i)
        noise.push_back(
            plan.noiseOf(predicted[i].luminance, predicted[i].deviation, points[i].slot));
    if (adaptive) {
        plan.budget.emplace(noise, samples);
        plan.predictedError = plan.budget->predictedError();
    }

    // Heaviness from which on samples are reused, as if each pixel had kJudgedSamples.
    std::vector<VarianceByHeaviness> parts(found.size());
    const auto addHeaviness = [&](std::size_t i, std::size_t chunk, const Regions& fine) {
        parts[chunk].add(varianceByHeaviness(fine, ShareRules(), plan.brightness(), noise[i].scale),
                         samples / (kJudgedSamples * plan.samplesOf(noise[i], samples)),
                         1 / static_cast<double>(points.size()));
    };
    forEachPlace(places, plan.calibration, addHeaviness);
    VarianceByHeaviness all;
    for (const VarianceByHeaviness& part : parts) all.add(part, 1, 1);
    plan.heavy = all.heavyFrom(cameraRayError);
    return result;
}

}  // namespace shadowcache
