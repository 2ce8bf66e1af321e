#include "render/frame/sample_pilot.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/hash.h"
#include "common/base/parallel.h"
#include "common/base/tuned.h"
#include "common/random/salts.h"
#include "common/random/sequence.h"
#include "render/bounces/bounce_light.h"
#include "render/estimators/set_place.h"
#include "render/frame/predicted_rates.h"
#include "render/frame/shading.h"
#include "render/frame/tile_blocks.h"
#include "render/frame/visible_emitters.h"

namespace shadowcache {

namespace {

/// Pixels that the rule of a frame is made of.
SHADOWCACHE_TUNED(std::size_t, kRulePixels, 256);

/// Pixels or places that one thread takes at a time.
constexpr std::size_t kChunk = 32;

/// Camera rays of a pixel with 64 shadow rays, for which reuse is judged.
constexpr double kJudgedCameraRays = 16;

/// What some pixels are predicted to show; nothing where their camera rays do not matter.
std::optional<FrameSpread> predictFrame(const FrameRequest& frame, const FilmRays& film,
                                        ToolPool& pool) {
    const RenderOptions& options = frame.options;
    if (options.cameraRays < 2 || !frame.estimator.prediction()) return {};
    std::vector<PredictedSpread> pixels(kRulePixels);
    parallelFor(kRulePixels, kChunk, [&](const Chunk& chunk) {
        std::unique_ptr<TileTools> tools = pool.take();
        std::vector<FilmPlace> some;
        for (std::size_t k = chunk.begin; k < chunk.end; ++k) {
            const std::uint64_t seed =
                pixelSeed(options.seed, frame.number, -1, -1, static_cast<int>(k));
            const auto at = [&](std::uint64_t axis, int size) {
                return static_cast<int>(toUnit(hashWords(seed, FrameSalt::rulePixel, axis)) * size);
            };
            some.push_back({at(0, options.width), at(1, options.height)});
        }
        std::ranges::copy(predictSpreads(frame, film, some, kMostSpreadRays, *tools),
                          pixels.begin() + static_cast<std::ptrdiff_t>(chunk.begin));
        pool.giveBack(std::move(tools));
    });
    return spreadOf(pixels);
}

/// Places on the film, evenly spread.
std::vector<FilmPosition> pilotPlaces(const FrameRequest& frame, std::size_t count) {
    const std::uint64_t seed =
        hashWords(pixelSeed(frame.options.seed, frame.number, -1, -1, 0), FrameSalt::pilotPlaces);
    std::vector<std::uint32_t> columns(count), rows(count);
    owenSobol(0, 0, seed, columns);
    owenSobol(0, 1, seed, rows);
    std::vector<FilmPosition> places(count);
    for (std::size_t k = 0; k < count; ++k)
        places[k] = {static_cast<double>(toUnitFloat(columns[k])),
                     static_cast<double>(toUnitFloat(rows[k]))};
    return places;
}

/// A place that a pilot looks at.
struct PilotPlace {
    ShadingPoint point;
    Rgb albedo;  ///< of its diffuse part
};

/// The one that a pilot looks at through a place of the film; nothing where that shows the sky.
///
/// @param floor  as AntialiasingRule has it; none: errors are relative to the place's own light
std::optional<PilotPlace> pilotPlace(const FrameRequest& frame, const FilmRays& film,
                                     const FilmPosition& at, std::uint64_t seed,
                                     std::optional<double> floor, TileTools& tools) {
    const View view = film.look(at).view;
    if (!view.hit.found) return {};
    const RenderOptions& options = frame.options;
    const EstimatorContext& context = frame.estimator.context();
    const FilmPlace pixel{static_cast<int>(at.x * options.width),
                          static_cast<int>(at.y * options.height)};
    ShadingPoint point{placeOf(context.scene, view),
                       {.seed = seed, .filmX = pixel.x, .filmY = pixel.y}};
    const Rgb albedo = diffuseAlbedo(surfaceSeen(view.hit, options.plain),
                                     -point.place.normal.dot(view.direction));
    if (floor) {
        const double scale =
            predictSpreads(frame, film, std::span(&pixel, 1), kMostSpreadRays, tools)
                .front()
                .errorScale(*floor);
        point.slot.errorScale = irradianceScale(context.environment, scale, albedo);
    }
    return PilotPlace{point, albedo};
}

/// What paths from the pilot's places tell.
PathPilot pathsFrom(const FrameRequest& frame, std::span<const ShadingPoint> points,
                    std::span<const Rgb> albedos, RenderStats& stats) {
    std::vector<BounceReceiver> receivers(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        receivers[i] = {.point = &points[i], .diffuseAlbedo = albedos[i]};
    const BounceLight bounces(frame.estimator, frame.plan.estimator.get(), bounceOptionsOf(frame));
    std::vector<BouncedLight> light(receivers.size());
    PathPilot paths;
    BounceCounts counts;
    bounces.gather(
        receivers, light, counts, [] {}, &paths);
    stats.bounces.add(counts);
    return paths;
}

/// At most `most` of them, evenly spread.
std::vector<ShadingPoint> thinned(std::span<const ShadingPoint> points, std::size_t most) {
    std::vector<ShadingPoint> some;
    const std::size_t step = (points.size() + most - 1) / most;
    for (std::size_t i = 0; i < points.size(); i += step) some.push_back(points[i]);
    return some;
}

/// Samples of direct light that a path's vertex has in the mean, where a camera ray has `samples`:
/// fewer, since many vertices light one pixel.
int samplesOfVertex(int samples) {
    return static_cast<int>(std::lround(std::sqrt(samples)));
}

}  // namespace

FramePlan planSamples(const FrameRequest& request, RenderStats& stats) {
    const RenderOptions& options = request.options;
    const FramePilot* pilot = request.estimator.pilot();
    if (!pilot) return {};
    const auto start = std::chrono::steady_clock::now();
    FrameRequest frame = request;
    frame.plan = {};
    FramePlan& plan = frame.plan;
    if (options.cameraRays > 1 && request.estimator.prediction() && pilot->isAdaptive()) {
        const auto visible = std::make_shared<const VisibleEmitters>(request);
        stats.spreadRays += visible->rays();
        plan.visibleEmitters = visible;
    }
    const FilmRays film(frame);
    const std::size_t places = pilot->places(static_cast<std::uint64_t>(options.width) *
                                             static_cast<std::uint64_t>(options.height) *
                                             static_cast<std::uint64_t>(options.cameraRays) *
                                             static_cast<std::uint64_t>(options.samples));
    ToolPool pool(frame.estimator);
    const std::optional<FrameSpread> spread = predictFrame(frame, film, pool);
    const auto floor = spread ? std::optional(spread->floor) : std::nullopt;
    const std::vector<FilmPosition> looked = pilotPlaces(frame, places);
    std::vector<std::optional<PilotPlace>> seen(places);
    parallelFor(places, kChunk, [&](const Chunk& chunk) {
        std::unique_ptr<TileTools> tools = pool.take();
        for (std::size_t k = chunk.begin; k < chunk.end; ++k)
            // The numbers of a pilot belong to no pixel.
            seen[k] = pilotPlace(frame, film, looked[k],
                                 pixelSeed(options.seed, frame.number, -1, -1, static_cast<int>(k)),
                                 floor, *tools);
        pool.giveBack(std::move(tools));
    });
    pool.addCounts(stats);
    std::vector<ShadingPoint> points;
    std::vector<Rgb> albedos;
    for (const std::optional<PilotPlace>& place : seen)
        if (place) {
            points.push_back(place->point);
            albedos.push_back(place->albedo);
        }
    plan.estimator = pilot->plan(
        points, options.samples,
        spread ? spread->cameraError / std::pow(kJudgedCameraRays, kStratification) : 0);
    stats.shadowRays += plan.estimator->rays;
    stats.cameraRays += places;
    if (spread && plan.estimator->predictedError)
        plan.antialiasing = makeAntialiasingRule(
            *spread,
            *plan.estimator->predictedError * static_cast<double>(points.size()) /
                static_cast<double>(std::max<std::size_t>(places, 1)),
            std::min(options.cameraRays, options.passRays), options.samples);
    plan.vertices = plan.estimator;
    if (options.bounces != 0 && options.sharedBounces && frame.estimator.context().solve) {
        const PathPilot paths = pathsFrom(frame, points, albedos, stats);
        plan.bounceTrust = paths.check.trust();
        if (!paths.vertices.empty()) {
            plan.vertices =
                pilot->plan(thinned(paths.vertices, places), samplesOfVertex(options.samples), 0);
            stats.shadowRays += plan.vertices->rays;
        }
    }
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    stats.seconds += seconds;
    stats.setupSeconds += seconds;
    return plan;
}

}  // namespace shadowcache
