// Error and time of antialiased pictures with light that bounces, over Blender's Cycles and over
// brute force: `mis` at each vertex of paths that share nothing.

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <optional>

#include "common/base/parallel.h"
#include "render/bounces/item_looks.h"
#include "tests/benchmarks/antialiased.h"
#include "tests/benchmarks/in_cycles.h"

namespace shadowcache::bench {

namespace {

constexpr int kBounces = 4, kSamples = 64;
constexpr Split kBruteForce{64, 1};

/// Seeds of the reference, whose mean it is, and the split of each.
constexpr int kReferenceSeeds = 8;
constexpr Split kReferenceSplit{64, 4};

double processorSeconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

RenderOptions optionsOf(const Split& split) {
    RenderOptions options = wholeView().options;
    options.cameraRays = split.cameraRays;
    options.samples = split.samples;
    options.bounces = kBounces;
    return options;
}

/// A set's transport, and what bounces under one map.
class Solves {
public:
    Solves(const Frame& frame)
        : items_(*frame.context.cache),
          transport_(readTransport(*frame.context.cache, items_).value()),
          looks_(looksOf(frame.context.scene, items_, PlainLook{})) {
        const double start = processorSeconds();
        solve_.emplace(*frame.context.cache, items_, transport_, frame.context.environment, looks_,
                       kBounces);
        seconds_ = (processorSeconds() - start) / threadCount();
    }
    const BounceSolve& solve() const { return *solve_; }
    double seconds() const { return seconds_; }

private:
    ItemTable items_;
    Transport transport_;
    std::vector<ItemLook> looks_;
    std::optional<BounceSolve> solve_;
    double seconds_ = 0;
};

/// Errors, means over seeds, and least seconds of the processor over the threads.
struct Result {
    RelativeError error;
    double seconds = 0, light = 0;
    double efficiency() const { return 1 / (error.mean * seconds); }
    double efficiencyOfP99() const { return 1 / (error.p99 * seconds); }
};

double meanOf(const Image& image) {
    double sum = 0;
    for (const Rgb& p : image.pixels) sum += static_cast<double>(p.x + p.y + p.z);
    return sum / static_cast<double>(3 * image.pixels.size());
}

Result measure(const Frame& frame, const std::string& estimator, RenderOptions options, int seeds,
               const Image& reference, double seconds) {
    Result result;
    for (int seed = 1; seed <= seeds; ++seed) {
        options.seed = static_cast<std::uint64_t>(seed);
        const Rendered r = renderWith(frame.context, frame.set, estimator, frame.number, options);
        const RelativeError e = relativeError(r.image, reference);
        result.error.mean += e.mean / seeds;
        result.error.p99 += e.p99 / seeds;
        result.error.max = std::max(result.error.max, e.max);
        result.light += meanOf(r.image) / meanOf(reference) / seeds;
        const double all = r.processorSeconds + seconds;
        result.seconds = seed == 1 ? all : std::min(result.seconds, all);
    }
    return result;
}

Image referenceOf(const Frame& frame) {
    RenderOptions options = optionsOf(kReferenceSplit);
    Image mean;
    for (int seed = 0; seed < kReferenceSeeds; ++seed) {
        options.seed = 1000 + static_cast<std::uint64_t>(seed);
        const Image image =
            renderWith(frame.context, frame.set, "cache", frame.number, options).image;
        if (seed == 0) mean = {image.width, image.height, std::vector<Rgb>(image.pixels.size())};
        for (std::size_t i = 0; i < image.pixels.size(); ++i)
            mean.pixels[i] += image.pixels[i] / static_cast<float>(kReferenceSeeds);
    }
    return mean;
}

void report(const std::string& key, const Result& result, const Result& cycles,
            const Result& bruteForce, JsonFile& json) {
    const double overCycles = result.efficiency() / cycles.efficiency(),
                 overBrute = result.efficiency() / bruteForce.efficiency(),
                 byP99 = result.efficiencyOfP99() / bruteForce.efficiencyOfP99();
    std::printf("%-44s %9.3g %9.3g %9.3g %8.3f %8.4f %8.2f %8.2f %8.2f\n", key.c_str(),
                result.error.mean, result.error.p99, result.error.max, result.seconds, result.light,
                overCycles, overBrute, byP99);
    std::fflush(stdout);
    json.set(key + ".relmse", result.error.mean);
    json.set(key + ".p99", result.error.p99);
    json.set(key + ".max", result.error.max);
    json.set(key + ".seconds", result.seconds);
    json.set(key + ".light", result.light);
    json.set(key + ".times_cycles", overCycles);
    json.set(key + ".times_brute_force", overBrute);
    json.set(key + ".times_brute_force_by_p99", byP99);
}

void compare(const Settings& settings, const Frame& bare, JsonFile& json) {
    const Solves solves(bare);
    EstimatorContext context = bare.context;
    context.solve = &solves.solve();
    const Frame frame{context, bare.set, bare.map, bare.number};
    const Image reference = referenceOf(frame);
    const int seeds = settings.seeds > 0 ? settings.seeds : 4;
    Result cycles;
    const Pair theirs = cyclesPair(settings, frame, kSamples, kBounces);
    cycles.error = theirs.noise(reference);
    cycles.seconds = theirs.seconds;
    cycles.light = meanOf(theirs.a) / meanOf(reference);
    RenderOptions alone = optionsOf(kBruteForce);
    alone.sharedBounces = false;
    const Result bruteForce = measure(bare, "mis", alone, seeds, reference, 0);
    report(frame.key() + ".cycles", cycles, cycles, bruteForce, json);
    report(frame.key() + ".brute_force", bruteForce, cycles, bruteForce, json);
    for (const std::string& text : settings.splits) {
        const Split split = parseSplit(text);
        report(frame.key() + "." + split.name(),
               measure(frame, "cache", optionsOf(split), seeds, reference, solves.seconds()),
               cycles, bruteForce, json);
    }
    RenderOptions preview = optionsOf(kBruteForce);
    preview.samples = 0;
    report(frame.key() + ".preview",
           measure(frame, "cache", preview, 1, reference, solves.seconds()), cycles, bruteForce,
           json);
}

}  // namespace

void bounces(const Settings& settings) {
    JsonFile json;
    std::printf("seconds: of the processor, over the threads, the solve included\n");
    std::printf("%-44s %9s %9s %9s %8s %8s %8s %8s %8s\n", "picture, 4 bounces", "relMSE", "p99",
                "max", "seconds", "light", "x Cycles", "x brute", "by p99");
    forEachFrame(settings, [&](const Frame& frame) { compare(settings, frame, json); });
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
