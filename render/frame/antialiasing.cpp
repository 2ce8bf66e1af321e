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

/// Cost of a sample, in camera rays: its ray and what reusing it costs against a camera ray, its
/// lookup and its place in a cluster.
SHADOWCACHE_TUNED(double, kSampleCost, 0.4);

/// Rounds in which the rule and what it does to a frame come to agree.
constexpr int kRounds = 12;

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

/// Camera rays that pay for a pixel, for each that is asked for.
int rayFactorOf(double variance, const AntialiasingRule& rule) {
    int factor = 1;
    for (double least = rule.least; 2 * factor <= rule.most && variance > least; factor *= 2)
        least *= std::exp2(1 + kStratification);
    return factor;
}

}  // namespace

double PredictedSpread::relativeVariance(double floor) const {
    const double square = mean() * mean();
    const double variance = count > 0 ? std::max(0.0, squares / count - square) : 0;
    return square + floor > 0 ? variance / (square + floor) : 0;
}

FrameSpread spreadOf(std::span<const PredictedSpread> pixels) {
    FrameSpread frame;
    const auto count = static_cast<double>(std::max<std::size_t>(pixels.size(), 1));
    double mean = 0;
    for (const PredictedSpread& pixel : pixels) mean += pixel.mean() / count;
    frame.floor = 0.01 * mean * mean;
    // n values about their own mean vary by (n - 1) / n too little.
    for (const PredictedSpread& pixel : pixels) {
        frame.variances.push_back(pixel.count > 1 ? pixel.relativeVariance(frame.floor) *
                                                        pixel.count / (pixel.count - 1)
                                                  : 0);
        frame.cameraError += frame.variances.back() / count;
    }
    return frame;
}

AntialiasingRule makeAntialiasingRule(const FrameSpread& frame, double lightError, int cameraRays,
                                      int samples) {
    AntialiasingRule rule{frame.floor, std::numeric_limits<double>::infinity(),
                          std::clamp(kEnoughCameraRays / cameraRays, kLeastMost, kMostRayFactor)};
    // With e = kStratification, twice the camera rays of a pixel that has M lower its error v / M^e
    // by 1 - 2^-e of it and cost M: worth it if that share of the frame's error is more than the
    // share of its cost. Both fall and grow with the rays that other pixels get.
    const double halved = 1 - std::exp2(-kStratification);
    const double stratified = std::pow(cameraRays, kStratification);
    const auto count = static_cast<double>(std::max<std::size_t>(frame.variances.size(), 1));
    for (int round = 0; round < kRounds; ++round) {
        double error = lightError / cameraRays, cost = kSampleCost * samples;
        for (const double variance : frame.variances) {
            const int factor = rayFactorOf(variance, rule);
            error += variance / (stratified * std::pow(factor, kStratification)) / count;
            cost += factor / count;
        }
        rule.least = stratified * error / (halved * cost);
    }
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

int rayFactorOf(const PredictedSpread& pixel, const AntialiasingRule& rule) {
    return rayFactorOf(pixel.relativeVariance(rule.floor), rule);
}

}  // namespace shadowcache
