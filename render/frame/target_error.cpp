#include "render/frame/target_error.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "common/base/hash.h"
#include "common/base/tuned.h"
#include "common/random/salts.h"
#include "render/frame/pilot.h"
#include "render/frame/tiles.h"

namespace shadowcache {

namespace {

/// Camera rays of the pilot, which sees all tiles: enough for a spread.
SHADOWCACHE_TUNED(int, kTargetPilotRays, 8);

/// Least camera rays of a pixel: fewer leave jagged edges.
constexpr int kLeastTargetRays = 4;

/// Tiles of the frame for each tile of the check.
SHADOWCACHE_TUNED(std::size_t, kTilesApart, 16);

/// A tile's error counts as at least this share of the mean one: a few rays can miss what is rare.
constexpr double kLeastTileShare = 0.1;

/// How far the check may move the plan.
constexpr double kMostPlanCorrection = 8;

constexpr std::uint64_t kPilotSeed = 0x70696c6f74;

/// Luminance error of pixels, relative as relMSE has it.
class ErrorScale {
public:
    ErrorScale(const Rgb& weights, std::span<const Pixel> pixels) : weights_(weights) {
        for (const Pixel& p : pixels)
            mean_ += luminance(p.color) / static_cast<double>(pixels.size());
    }

    /// Mean over the colours of squared errors, as relativeError has it.
    double relativeRgb(const Rgb& error, const Rgb& color) const {
        double sum = 0;
        for (int k = 0; k < 3; ++k) {
            const auto e = static_cast<double>(error[k]), value = static_cast<double>(color[k]);
            const double scale = value * value + 0.01 * mean_ * mean_;
            if (scale > 0) sum += e * e / scale / 3;
        }
        return sum;
    }

    double luminance(const Rgb& c) const { return static_cast<double>(c.dot(weights_)); }
    double relative(double squaredError, const Rgb& color) const {
        const double value = luminance(color);
        const double scale = value * value + 0.01 * mean_ * mean_;
        return scale > 0 ? squaredError / scale : 0;
    }

private:
    const Rgb weights_;
    double mean_ = 0;
};

/// Error of each tile's pixels, added up, and how many they are.
struct TileError {
    double sum = 0, pixels = 0;
};

/// Camera rays of tiles for the least cost: errors fall as 1 / rays, so rays go with their roots.
std::vector<int> shareOut(std::span<const TileError> tiles, double target) {
    TileError all;
    for (const TileError& tile : tiles) {
        all.sum += tile.sum;
        all.pixels += tile.pixels;
    }
    const double least = kLeastTileShare * all.sum / all.pixels;
    const auto root = [&](const TileError& tile) {
        return tile.pixels > 0 ? std::sqrt(std::max(least, tile.sum / tile.pixels)) : 0.0;
    };
    double roots = 0;
    for (const TileError& tile : tiles) roots += tile.pixels * root(tile);
    std::vector<int> rays;
    for (const TileError& tile : tiles)
        rays.push_back(static_cast<int>(std::clamp(
            std::ceil(kTargetPilotRays * root(tile) * roots / (all.pixels * target)),
            static_cast<double>(kLeastTargetRays), static_cast<double>(kMostCameraRays))));
    return rays;
}

/// Error found in some tiles over the planned one, and over that estimated from the spread of their
/// camera rays.
struct Correction {
    double plan, estimated;
};

/// From two renders that share no number with each other or the pilot.
Correction checkPlan(FrameRequest frame, std::span<const TileError> pilot, const ErrorScale& scale,
                     RenderStats& stats) {
    // Where rays are many, a quarter of them will do.
    for (int& rays : frame.tileRays)
        rays = std::max(std::min(rays, 2 * kTargetPilotRays), rays / 4);
    frame.options.cameraRays = std::ranges::max(frame.tileRays);
    std::vector<std::size_t> some;
    for (std::size_t t = 0; t < frame.tileRays.size(); t += kTilesApart)
        some.push_back(
            std::min(t + hashWords(frame.options.seed, FrameSalt::someTiles, t) % kTilesApart,
                     frame.tileRays.size() - 1));
    frame.options.seed += kPilotSeed;
    const auto a = renderSomeTiles(frame, some, stats);
    frame.options.seed += kPilotSeed;
    const auto b = renderSomeTiles(frame, some, stats);
    double found = 0, expected = 0, estimated = 0;
    for (std::size_t i = 0; i < some.size(); ++i) {
        expected += pilot[some[i]].sum * kTargetPilotRays / frame.tileRays[some[i]];
        for (std::size_t p = 0; p < a[i].size(); ++p) {
            const Rgb mean = (a[i][p].color + b[i][p].color) * 0.5f;
            const double variance = static_cast<double>(a[i][p].colorVariance) +
                                    static_cast<double>(b[i][p].colorVariance);
            estimated += scale.relative(0.5 * variance, mean);
            found += scale.relativeRgb(a[i][p].color - b[i][p].color, mean) / 2;
        }
    }
    const auto ratio = [&](double value) {
        return value > 0 ? std::clamp(found / value, 1 / kMostPlanCorrection, kMostPlanCorrection)
                         : 1.0;
    };
    return {ratio(expected), ratio(estimated)};
}

}  // namespace

double measuredError(std::span<const Pixel> pixels, const Rgb& luminanceWeights) {
    if (pixels.empty()) return 0;
    const ErrorScale scale(luminanceWeights, pixels);
    double error = 0;
    for (const Pixel& p : pixels)
        error += scale.relative(static_cast<double>(p.colorVariance), p.color);
    return error / static_cast<double>(pixels.size());
}

TargetPlan planForError(FrameRequest frame, double target, RenderStats& stats) {
    const std::uint64_t seed = frame.options.seed;
    std::vector<std::size_t> all(Tiles(frame.options).touching(frame.options.region()).size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    frame.tileRays.clear();
    frame.options.cameraRays = kTargetPilotRays;
    frame.options.seed = seed ^ kPilotSeed;
    frame.plan = planFrame(frame, stats);
    const auto tiles = renderSomeTiles(frame, all, stats);
    std::vector<Pixel> pixels;
    for (const auto& tile : tiles) pixels.insert(pixels.end(), tile.begin(), tile.end());
    const ErrorScale scale(frame.estimator.context().environment.luminanceWeights(), pixels);
    std::vector<TileError> errors;
    for (const auto& tile : tiles) {
        TileError& error = errors.emplace_back();
        error.pixels = static_cast<double>(tile.size());
        for (const Pixel& p : tile)
            error.sum += scale.relative(static_cast<double>(p.colorVariance), p.color);
    }
    frame.tileRays = shareOut(errors, target);
    const Correction correction = checkPlan(frame, errors, scale, stats);
    frame.tileRays = shareOut(errors, target / correction.plan);
    frame.options.cameraRays = std::ranges::max(frame.tileRays);
    frame.options.seed = seed;
    frame.plan = planFrame(frame, stats);
    return {std::move(frame), correction.estimated};
}

}  // namespace shadowcache
