#include "render/frame/antialiasing.h"

#include <algorithm>

#include "common/base/tuned.h"

namespace shadowcache {

namespace {

/// Most camera rays of a pixel for each that is asked for.
SHADOWCACHE_TUNED(int, kMostRayFactor, 4);

/// Cost of a sample, in camera rays: its ray and what reusing it costs against a camera ray, its
/// lookup and its place in a cluster.
SHADOWCACHE_TUNED(double, kSampleCost, 0.6);

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
    for (const PredictedSpread& pixel : pixels)
        if (pixel.count > 1)
            frame.cameraError +=
                pixel.relativeVariance(frame.floor) * pixel.count / (pixel.count - 1) / count;
    return frame;
}

AntialiasingRule makeAntialiasingRule(const FrameSpread& frame, double lightError, int samples) {
    // Twice the camera rays of a pixel lower its error v / M by v / 2 M and cost M: worth it if
    // that share of the frame's error is more than the share of its cost.
    return {frame.floor, 2 * (lightError + frame.cameraError) / (1 + kSampleCost * samples)};
}

std::vector<int> rayFactorsOf(std::span<const FilmPlace> places,
                              std::span<const PredictedSpread> spreads,
                              const AntialiasingRule& rule) {
    std::vector<int> factors;
    const PixelMap map(places);
    for (const FilmPlace& place : places) {
        PredictedSpread around;
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
                const int i = map.at(place.x + dx, place.y + dy);
                if (i < 0) continue;
                around.add(spreads[static_cast<std::size_t>(i)],
                           (dx == 0 ? 1 : kBeside) * (dy == 0 ? 1 : kBeside));
            }
        const double variance = around.relativeVariance(rule.floor);
        int factor = 1;
        while (factor < kMostRayFactor && variance > factor * factor * rule.least) factor *= 2;
        factors.push_back(factor);
    }
    return factors;
}

}  // namespace shadowcache
