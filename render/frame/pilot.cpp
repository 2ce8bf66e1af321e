#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <vector>

#include "common/base/hash.h"
#include "common/base/parallel.h"
#include "common/base/tuned.h"
#include "common/random/salts.h"
#include "render/frame/integrator.h"
#include "render/frame/tile_renderer.h"

namespace shadowcache {

namespace {

/// Pixels that the rule of a frame is made of.
SHADOWCACHE_TUNED(std::size_t, kRulePixels, 256);

/// Camera rays of a pixel with 64 shadow rays, for which reuse is judged.
constexpr double kJudgedCameraRays = 16;

/// What some pixels are predicted to show; nothing where their camera rays do not matter.
std::optional<FrameSpread> predictFrame(const FrameRequest& frame, const TileRenderer& renderer,
                                        RenderStats& stats) {
    const RenderOptions& options = frame.options;
    if (options.cameraRays < 2 || !frame.estimator.prediction()) return {};
    std::vector<PredictedSpread> pixels(kRulePixels);
    parallelFor(kRulePixels, kRulePixels / 8, [&](const Chunk& chunk) {
        const auto workspace = frame.estimator.makeWorkspace();
        TileScratch scratch;
        for (std::size_t k = chunk.begin; k < chunk.end; ++k) {
            const std::uint64_t seed =
                pixelSeed(options.seed, frame.number, -1, -1, static_cast<int>(k));
            const auto at = [&](std::uint64_t axis, int size) {
                return static_cast<int>(toUnit(hashWords(seed, FrameSalt::rulePixel, axis)) * size);
            };
            pixels[k] = renderer.predictSpread({at(0, options.width), at(1, options.height)},
                                               kMostSpreadRays, scratch, *workspace);
        }
    });
    stats.spreadRays += kRulePixels * kMostSpreadRays;
    return spreadOf(pixels);
}

}  // namespace

void runPilot(FrameRequest& frame, RenderStats& stats) {
    const RenderOptions& options = frame.options;
    frame.antialiasing.reset();
    FramePilot* pilot = frame.estimator.pilot();
    if (options.samples == 0 || !pilot) return;
    const auto start = std::chrono::steady_clock::now();
    const TileRenderer renderer(frame);
    const std::size_t places = pilot->places(static_cast<std::uint64_t>(options.width) *
                                             static_cast<std::uint64_t>(options.height) *
                                             static_cast<std::uint64_t>(options.cameraRays) *
                                             static_cast<std::uint64_t>(options.samples));
    const std::optional<FrameSpread> spread = predictFrame(frame, renderer, stats);
    const auto floor = spread ? std::optional(spread->floor) : std::nullopt;
    std::vector<std::optional<ShadingPoint>> seen(places);
    parallelFor(places, 256, [&](const Chunk& chunk) {
        const auto workspace = frame.estimator.makeWorkspace();
        TileScratch scratch;
        for (std::size_t k = chunk.begin; k < chunk.end; ++k) {
            // The numbers of a pilot belong to no pixel.
            const std::uint64_t seed =
                pixelSeed(options.seed, frame.number, -1, -1, static_cast<int>(k));
            const FilmPosition at{toUnit(hashWords(seed, FrameSalt::pilotColumn)),
                                  toUnit(hashWords(seed, FrameSalt::pilotRow))};
            seen[k] = renderer.pilotPoint(at, seed, floor, scratch, *workspace);
        }
    });
    std::vector<ShadingPoint> points;
    for (const std::optional<ShadingPoint>& point : seen)
        if (point) points.push_back(*point);
    if (floor) stats.spreadRays += points.size() * kMostSpreadRays;
    stats.shadowRays +=
        pilot->run(points, options.samples,
                   spread ? spread->cameraError / std::pow(kJudgedCameraRays, kStratification) : 0);
    stats.cameraRays += places;
    const LightPrediction* prediction = frame.estimator.prediction();
    if (spread && prediction->predictedError())
        frame.antialiasing = makeAntialiasingRule(
            *spread,
            *prediction->predictedError() * static_cast<double>(points.size()) /
                static_cast<double>(std::max<std::size_t>(places, 1)),
            std::min(options.cameraRays, options.passRays), options.samples);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    stats.seconds += seconds;
    stats.setupSeconds += seconds;
}

}  // namespace shadowcache
