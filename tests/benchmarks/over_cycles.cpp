// Noise and seconds of antialiased pictures against those of Blender's Cycles, which the same users
// could take instead.

#include <algorithm>
#include <cstdio>

#include "tests/benchmarks/antialiased.h"
#include "tests/benchmarks/in_cycles.h"

namespace shadowcache::bench {

namespace {

constexpr int kSamples = 64;
constexpr Split kSplits[] = {{16, 4}, {64, 1}};

Pair ourPair(const Frame& frame, const Split& split) {
    RenderOptions options = wholeView().options;
    options.cameraRays = split.cameraRays;
    options.samples = split.samples;
    const auto renderSeed = [&](std::uint64_t seed) {
        options.seed = seed;
        return renderWith(frame.context, frame.set, "cache", frame.number, options);
    };
    const Rendered a = renderSeed(1), b = renderSeed(2);
    return {a.image, b.image, std::min(a.processorSeconds, b.processorSeconds)};
}

double meanOf(const Image& image) {
    double sum = 0;
    for (const Rgb& p : image.pixels) sum += static_cast<double>(p.x + p.y + p.z);
    return sum / static_cast<double>(3 * image.pixels.size());
}

void report(const std::string& key, const Pair& pair, const RelativeError& noise,
            const std::pair<double, double>& gain, double light, JsonFile& json) {
    std::printf("%-48s %9.3g %9.3g %8.3f %8.2f %8.2f %8.4f\n", key.c_str(), noise.mean, noise.p99,
                pair.seconds, gain.first, gain.second, light);
    std::fflush(stdout);
    json.set(key + ".relmse", noise.mean);
    json.set(key + ".p99", noise.p99);
    json.set(key + ".seconds", pair.seconds);
    json.set(key + ".times_cycles", gain.first);
    json.set(key + ".times_cycles_by_p99", gain.second);
    json.set(key + ".light", light);
}

}  // namespace

void overCycles(const Settings& settings) {
    JsonFile json;
    std::printf("seconds: of the processor, over the threads\n%-48s %9s %9s %8s %8s %8s %8s\n",
                "picture", "relMSE", "p99", "seconds", "x Cycles", "by p99", "light");
    forEachFrame(settings, [&](const Frame& frame) {
        const Image reference = antialiasedReference(frame, wholeView(), settings.work).image;
        const double light = meanOf(reference);
        const Pair theirs = cyclesPair(settings, frame, kSamples, 0);
        const RelativeError noise = theirs.noise(reference);
        report(frame.key() + "." + Split{kSamples, 1}.name() + ".cycles", theirs, noise, {1, 1},
               meanOf(theirs.a) / light, json);
        for (const Split& split : kSplits) {
            const Pair ours = ourPair(frame, split);
            const RelativeError own = ours.noise(reference);
            const double quicker = theirs.seconds / ours.seconds;
            report(frame.key() + "." + split.name() + ".cache", ours, own,
                   {noise.mean / own.mean * quicker, noise.p99 / own.p99 * quicker},
                   meanOf(ours.a) / light, json);
        }
    });
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
