#include "render/frame/antialiasing.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/tuned.h"

namespace shadowcache {

namespace {

/// Most camera rays of a pixel for each that is asked for. The memory of a tile grows with it.
SHADOWCACHE_TUNED(int, kMostRayFactor, 16);
/// Most camera rays of a pixel, or kLeastMost times those that are asked for if that is more.
constexpr int kEnoughCameraRays = 256, kLeastMost = 4;
/// Most emission rays of a pixel, or kLeastMost times its camera rays if that is more.
SHADOWCACHE_TUNED(int, kEnoughEmissionRays, 1024);

/// Most camera rays of a pixel for each that is asked for, on the mean over a frame, as users plan
/// by what they ask for. Pixels beside rough ones get more as well, so that this makes up to 1.5.
SHADOWCACHE_TUNED(double, kMostMeanFactor, 1.25);

/// Cost of an emission ray, in camera rays: it is lit by nothing.
SHADOWCACHE_TUNED(double, kEmissionRayCost, 0.1);

/// Cost of a sample, in camera rays: its ray and what reusing it costs against a camera ray, its
/// lookup and its place in a cluster.
SHADOWCACHE_TUNED(double, kSampleCost, 0.4);

/// Rounds in which the rule and what it does to a frame come to agree.
constexpr int kRounds = 12;
/// Steps of the rule where it wants more rays than there may be.
constexpr double kStricter = 1.25;

/// Weight of the pixels beside one in its spread; of those at its corners, the square.
constexpr double kBeside = 0.5;

/// Numbers of a tile's pixels, by place.
class PixelMap {
public:
    explicit PixelMap(std::span<const FilmPlace> places) {
        const auto [left, right] = std::ranges::minmax(places, {}, &FilmPlace::x);
        const auto [top, bottom] = std::ranges::minmax(places, {}, &FilmPlace::y);
        x_ = left.x;
        y_ = top.y;
        width_ = right.x - x_ + 1;
        height_ = bottom.y - y_ + 1;
        numbers_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), -1);
        for (std::size_t i = 0; i < places.size(); ++i)
            numbers_[indexOf(places[i].x - x_, places[i].y - y_)] = static_cast<int>(i);
    }

    /// -1: of another tile.
    int at(int x, int y) const {
        x -= x_;
        y -= y_;
        if (x < 0 || y < 0 || x >= width_ || y >= height_) return -1;
        return numbers_[indexOf(x, y)];
    }

private:
    std::size_t indexOf(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(x);
    }

    int x_, y_, width_, height_;
    std::vector<int> numbers_;
};

/// Share of an error that twice the rays take away.
const double kHalved = 1 - std::exp2(-kStratification);

/// Rays of one kind for a pixel, for each camera ray that is asked for.
struct Rays {
    int factor = 1;
    double error = 0;  ///< that they leave, times K^kStratification for K that are asked for
    double cost = 0;   ///< [camera rays that are asked for]
};

/// Those that pay if twice as many as asked for pay from a relative variance of `least` on.
///
/// @param cost  of one, in camera rays
Rays raysFor(double variance, double cost, double least, int most) {
    Rays rays;
    for (least *= cost; 2 * rays.factor <= most && variance > least; rays.factor *= 2)
        least *= std::exp2(1 + kStratification);
    rays.error = variance / std::pow(rays.factor, kStratification);
    rays.cost = cost * rays.factor;
    return rays;
}

/// Rays of a pixel, and what they leave and cost together.
struct PixelRays {
    int rayFactor, emissionFactor;
    double error, cost;
};

/// Camera rays alone, or with emission rays: what leaves less, the cost counted as the error that
/// it would take away elsewhere.
PixelRays raysFor(const PixelVariances& pixel, const AntialiasingRule& rule) {
    const Rays all = raysFor(pixel.all, 1, rule.least, rule.most);
    const Rays reflected = raysFor(pixel.reflected, 1, rule.least, rule.most);
    const Rays emitted = raysFor(pixel.emitted, kEmissionRayCost, rule.least, rule.mostEmission);
    const PixelRays together{all.factor, 0, all.error, all.cost};
    const PixelRays apart{reflected.factor, emitted.factor, reflected.error + emitted.error,
                          reflected.cost + emitted.cost};
    const auto total = [&](const PixelRays& rays) {
        return rays.error + kHalved * rule.least * rays.cost;
    };
    return emitted.factor > 1 && total(apart) < total(together) ? apart : together;
}

/// Camera rays of a pixel on the mean over a frame, for each that is asked for.
double meanFactor(const FrameSpread& frame, const AntialiasingRule& rule) {
    double sum = 0;
    for (const PixelVariances& pixel : frame.variances) sum += raysFor(pixel, rule).rayFactor;
    return sum / static_cast<double>(std::max<std::size_t>(frame.variances.size(), 1));
}

}  // namespace

PixelVariances PredictedSpread::variances(double floor) const {
    const double scale = mean() * mean() + floor;
    const auto of = [&](const Moments& part) {
        if (count <= 0 || scale <= 0) return 0.0;
        const double partMean = part.sum / count;
        return std::max(0.0, part.squares / count - partMean * partMean) / scale;
    };
    return {of(all), of(reflected), of(emitted)};
}

FrameSpread spreadOf(std::span<const PredictedSpread> pixels) {
    FrameSpread frame;
    const auto count = static_cast<double>(std::max<std::size_t>(pixels.size(), 1));
    double mean = 0;
    for (const PredictedSpread& pixel : pixels) mean += pixel.mean() / count;
    frame.floor = 0.01 * mean * mean;
    for (const PredictedSpread& pixel : pixels) {
        PixelVariances variances;
        if (pixel.count > 1) variances = pixel.variances(frame.floor);
        // n values about their own mean vary by (n - 1) / n too little.
        for (double* v : {&variances.all, &variances.reflected, &variances.emitted})
            *v *= pixel.count / std::max(1.0, pixel.count - 1);
        frame.cameraError += variances.all / count;
        frame.variances.push_back(variances);
    }
    return frame;
}

AntialiasingRule makeAntialiasingRule(const FrameSpread& frame, double lightError, int cameraRays,
                                      int samples) {
    AntialiasingRule rule{frame.floor, std::numeric_limits<double>::infinity(),
                          std::clamp(kEnoughCameraRays / cameraRays, kLeastMost, kMostRayFactor),
                          std::max(kEnoughEmissionRays / cameraRays, kLeastMost)};
    // With e = kStratification, twice the camera rays of a pixel that has M lower its error v / M^e
    // by 1 - 2^-e of it and cost M: worth it if that share of the frame's error is more than the
    // share of its cost. Both fall and grow with the rays that other pixels get.
    const double stratified = std::pow(cameraRays, kStratification);
    const auto count = static_cast<double>(std::max<std::size_t>(frame.variances.size(), 1));
    for (int round = 0; round < kRounds; ++round) {
        double error = lightError / cameraRays, cost = kSampleCost * samples;
        for (const PixelVariances& pixel : frame.variances) {
            const PixelRays rays = raysFor(pixel, rule);
            error += rays.error / stratified / count;
            cost += rays.cost / count;
        }
        rule.least = stratified * error / (kHalved * cost);
    }
    while (meanFactor(frame, rule) > kMostMeanFactor) rule.least *= kStricter;
    return rule;
}

std::vector<PredictedSpread> withNeighbors(std::span<const FilmPlace> places,
                                           std::span<const PredictedSpread> spreads) {
    std::vector<PredictedSpread> sums;
    const PixelMap map(places);
    for (const FilmPlace& place : places) {
        PredictedSpread& sum = sums.emplace_back();
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
                const int i = map.at(place.x + dx, place.y + dy);
                if (i < 0) continue;
                sum.add(spreads[static_cast<std::size_t>(i)],
                        (dx == 0 ? 1 : kBeside) * (dy == 0 ? 1 : kBeside));
            }
    }
    return sums;
}

AdaptiveRate rateOf(const PredictedSpread& pixel, const AntialiasingRule& rule) {
    const PixelRays rays = raysFor(pixel.variances(rule.floor), rule);
    return {rays.rayFactor, rays.emissionFactor, pixel.errorScale(rule.floor)};
}

}  // namespace shadowcache
