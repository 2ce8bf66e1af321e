// Error and time of antialiased pictures with light that bounces, over Blender's Cycles and over
// brute force: `mis` at each vertex of paths that share nothing.

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <limits>
#include <optional>

#include "common/base/parallel.h"
#include "render/bounces/item_looks.h"
#include "tests/benchmarks/antialiased.h"
#include "tests/benchmarks/geometric_means.h"
#include "tests/benchmarks/in_cycles.h"

namespace shadowcache::bench {

namespace {

constexpr int kBounces = 4, kSamples = 64;
constexpr Split kBruteForce{64, 1};

/// Renders of the reference, whose mean it is, and the split of each. It is what errors are
/// relative to; its own noise counts in the error of the preview alone.
constexpr int kReferenceRenders = 4;
constexpr Split kReferenceSplit{16, 4};

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
    explicit Solves(const Frame& frame)
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

/// Errors, means over pairs of seeds or over seeds, and least seconds of the processor over the
/// threads.
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

void addMean(const RelativeError& error, int count, RelativeError& mean) {
    mean.mean += error.mean / count;
    mean.p99 += error.p99 / count;
    mean.p999 += error.p999 / count;
    mean.max = std::max(mean.max, error.max);
}

/// Noise as Cycles' is measured, from pairs of seeds: a reference's own noise does not count.
Result measure(const Frame& frame, const std::string& estimator, RenderOptions options, int pairs,
               const Image& reference, double seconds) {
    Result result;
    result.seconds = std::numeric_limits<double>::infinity();
    const auto renderSeed = [&](int seed) {
        options.seed = static_cast<std::uint64_t>(seed);
        Rendered r = renderWith(frame.context, frame.set, estimator, frame.number, options);
        result.light += meanOf(r.image) / meanOf(reference) / (2 * pairs);
        result.seconds = std::min(result.seconds, r.processorSeconds + seconds);
        return r.image;
    };
    for (int i = 0; i < pairs; ++i) {
        const Image a = renderSeed(2 * i + 1), b = renderSeed(2 * i + 2);
        addMean(Pair{a, b, 0}.noise(reference), pairs, result.error);
    }
    return result;
}

/// Error of the prediction, which has no noise.
Result measurePreview(const Frame& frame, const Image& reference, double seconds) {
    RenderOptions options = optionsOf({64, 1});
    options.samples = 0;
    const Rendered r = renderWith(frame.context, frame.set, "cache", frame.number, options);
    return {relativeError(r.image, reference), r.processorSeconds + seconds,
            meanOf(r.image) / meanOf(reference)};
}

Image referenceOf(const Settings& settings, const Frame& frame) {
    return makeReference(frame.context, frame.set, frame.number, optionsOf(kReferenceSplit),
                         settings.work, frame.key() + ".bounces", kReferenceRenders)
        .image;
}

void report(const std::string& key, const Result& result, const Result& cycles,
            const Result& bruteForce, JsonFile& json) {
    const double overCycles = result.efficiency() / cycles.efficiency(),
                 overBrute = result.efficiency() / bruteForce.efficiency(),
                 byP99 = result.efficiencyOfP99() / bruteForce.efficiencyOfP99();
    std::printf("%-44s %9.3g %9.3g %9.3g %9.3g %8.3f %8.4f %8.2f %8.2f %8.2f\n", key.c_str(),
                result.error.mean, result.error.p99, result.error.p999, result.error.max,
                result.seconds, result.light, overCycles, overBrute, byP99);
    std::fflush(stdout);
    json.set(key + ".relmse", result.error.mean);
    json.set(key + ".p99", result.error.p99);
    json.set(key + ".p999", result.error.p999);
    json.set(key + ".max", result.error.max);
    json.set(key + ".seconds", result.seconds);
    json.set(key + ".light", result.light);
    json.set(key + ".times_cycles", overCycles);
    json.set(key + ".times_brute_force", overBrute);
    json.set(key + ".times_brute_force_by_p99", byP99);
}

/// Over all pictures, by set and split.
struct Summary {
    GeometricMeans overCycles, overBruteForce;

    void add(const std::string& name, const Result& result, const Result& cycles,
             const Result& bruteForce) {
        overCycles.add(name, result.efficiency() / cycles.efficiency());
        overBruteForce.add(name, result.efficiency() / bruteForce.efficiency());
    }
};

void compare(const Settings& settings, const Frame& bare, JsonFile& json, Summary& summary) {
    const Solves solves(bare);
    EstimatorContext context = bare.context;
    context.solve = &solves.solve();
    const Frame frame{context, bare.set, bare.map, bare.number};
    const Image reference = referenceOf(settings, frame);
    const int pairs = settings.seeds > 0 ? std::max(1, settings.seeds / 2) : 2;
    Result cycles;
    const Pair theirs = cyclesPair(settings, frame, kSamples, kBounces);
    cycles.error = theirs.noise(reference);
    cycles.seconds = theirs.seconds;
    cycles.light = meanOf(theirs.a) / meanOf(reference);
    RenderOptions alone = optionsOf(kBruteForce);
    alone.sharedBounces = false;
    const Result bruteForce = measure(bare, "mis", alone, pairs, reference, 0);
    report(frame.key() + ".cycles", cycles, cycles, bruteForce, json);
    report(frame.key() + ".brute_force", bruteForce, cycles, bruteForce, json);
    for (const std::string& text : settings.splits) {
        const Split split = parseSplit(text);
        const Result cache =
            measure(frame, "cache", optionsOf(split), pairs, reference, solves.seconds());
        report(frame.key() + "." + split.name(), cache, cycles, bruteForce, json);
        summary.add(frame.set.name + " " + split.name(), cache, cycles, bruteForce);
    }
    report(frame.key() + ".preview", measurePreview(frame, reference, solves.seconds()), cycles,
           bruteForce, json);
}

}  // namespace

void bounces(const Settings& chosen) {
    const Settings settings = chosen.full ? fullMatrix(chosen) : chosen;
    JsonFile json;
    Summary summary;
    std::printf("seconds: of the processor, over the threads, the solve included\n");
    std::printf("%-44s %9s %9s %9s %9s %8s %8s %8s %8s %8s\n", "picture, 4 bounces", "relMSE",
                "p99", "p99.9", "max", "seconds", "light", "x Cycles", "x brute", "by p99");
    forEachFrame(settings, [&](const Frame& frame) { compare(settings, frame, json, summary); });
    summary.overCycles.print("efficiency over Cycles", "over_cycles", json);
    summary.overBruteForce.print("efficiency over brute force", "over_brute_force", json);
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
