#include "render/frame/target_error.h"

#include <algorithm>
#include <cmath>

namespace shadowcache {

namespace {

/// Samples of the first pilot; the second has a quarter of those that the first asks for.
constexpr int kPilotSamples = 16;

/// One tile in how many a pilot renders.
constexpr int kTilesApart = 16;

constexpr std::uint64_t kPilotSeed = 0x70696c6f74;

}  // namespace

double measuredError(std::span<const Pixel> pixels, const Rgb& luminanceWeights) {
    if (pixels.empty()) return 0;
    const auto luminance = [&](const Rgb& c) {
        return static_cast<double>(c.dot(luminanceWeights));
    };
    const auto count = static_cast<double>(pixels.size());
    double mean = 0;
    for (const Pixel& p : pixels) mean += luminance(p.color) / count;
    double error = 0;
    for (const Pixel& p : pixels) {
        const double value = luminance(p.color);
        const double scale = value * value + 0.01 * mean * mean;
        if (scale > 0) error += static_cast<double>(p.colorVariance) / scale / count;
    }
    return error;
}

int samplesForError(FrameRequest frame, double target, RenderStats& stats) {
    const auto needed = [&](int samples) {
        frame.options.samples = samples;
        runPilot(frame, stats);
        const double error =
            measuredError(renderSomeTiles(frame, kTilesApart, stats),
                          frame.estimator.context().environment.luminanceWeights());
        return static_cast<int>(std::clamp(std::ceil(samples * error / target), 1.0,
                                           static_cast<double>(kMostSamples)));
    };
    frame.options.seed ^= kPilotSeed;
    const int first = needed(kPilotSamples);
    const int wanted = first > kPilotSamples ? needed(std::max(kPilotSamples, first / 4)) : first;
    frame.options.seed ^= kPilotSeed;
    frame.options.samples = wanted;
    runPilot(frame, stats);
    return wanted;
}

}  // namespace shadowcache
