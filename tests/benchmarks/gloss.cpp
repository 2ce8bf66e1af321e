// Noise of glossy pictures with a cache against `mis`, by roughness.

#include <cstdio>

#include "tests/benchmarks/bench.h"

namespace shadowcache::bench {

namespace {

constexpr int kWidth = 160, kHeight = 90;

struct Split {
    int cameraRays, samples;
};
constexpr Split kSplits[] = {{16, 4}, {64, 1}};

/// Samples of a reference for each of the picture that it judges.
constexpr int kReferenceSamples = 16;

/// Of surfaces without a material of their own.
struct Look {
    const char* name;
    std::optional<Gloss> gloss;
};

std::vector<Look> looks() {
    std::vector<Look> all{{"diffuse", std::nullopt}};
    for (const float metallic : {1.0f, 0.0f})
        for (const float roughness : {0.5f, 0.3f, 0.2f, 0.1f})
            all.push_back({metallic > 0 ? "metal" : "varnish",
                           Gloss{.metallic = metallic, .roughness = roughness}});
    return all;
}

struct Measured {
    double error = 0, p99 = 0, seconds = 0;
};

struct View {
    const EstimatorContext& context;
    const Set& set;
    int frame, seeds;
};

/// Pictures of `cache` and of `mis`, against one of the same camera rays with more samples: what
/// remains is the noise of the light.
struct Both {
    Measured cache, mis;
};
Both compare(const View& view, const Look& look, const Split& split) {
    Both both;
    EstimatorOptions adaptive;
    adaptive.cache.adaptive = true;
    for (int seed = 1; seed <= view.seeds; ++seed) {
        RenderOptions options;
        options.width = kWidth;
        options.height = kHeight;
        options.seed = static_cast<std::uint64_t>(seed);
        options.plain.gloss = look.gloss;
        options.cameraRays = split.cameraRays;
        options.samples = split.samples * kReferenceSamples;
        const Image reference =
            renderWith(view.context, view.set, "cache", view.frame, options, adaptive).image;
        options.samples = split.samples;
        const auto measure = [&](const char* estimator, Measured& m) {
            const Rendered r =
                renderWith(view.context, view.set, estimator, view.frame, options, adaptive);
            const RelativeError e = relativeError(r.image, reference);
            m.error += e.mean / view.seeds;
            m.p99 += e.p99 / view.seeds;
            m.seconds = seed == 1 ? r.processorSeconds : std::min(m.seconds, r.processorSeconds);
        };
        measure("cache", both.cache);
        measure("mis", both.mis);
    }
    return both;
}

void report(const std::string& set, const std::string& map, const Look& look, const Split& split,
            const Both& both, JsonFile& json) {
    const double seconds = both.cache.seconds / both.mis.seconds;
    const double gain = both.mis.error / both.cache.error / seconds;
    const double byP99 = both.mis.p99 / both.cache.p99 / seconds;
    char roughness[16] = "", ofSplit[16];
    if (look.gloss)
        std::snprintf(roughness, sizeof roughness, "%.1f",
                      static_cast<double>(look.gloss->roughness));
    std::snprintf(ofSplit, sizeof ofSplit, "%dx%d", split.cameraRays, split.samples);
    std::printf("%-9s %-14s %-8s %4s %6s %9.3g %9.3g %8.2f %8.2f %8.2f\n", set.c_str(), map.c_str(),
                look.name, roughness, ofSplit, both.mis.error, both.cache.error, gain, byP99,
                seconds);
    std::fflush(stdout);
    const std::string key = set + "." + map + "." + look.name + roughness + "." + ofSplit;
    json.set(key + ".relmse_mis", both.mis.error);
    json.set(key + ".relmse", both.cache.error);
    json.set(key + ".times_mis", gain);
    json.set(key + ".times_mis_by_p99", byP99);
    json.set(key + ".seconds_over_mis", seconds);
}

}  // namespace

void gloss(const Settings& settings) {
    JsonFile json;
    std::printf("%-9s %-14s %-8s %4s %6s %9s %9s %8s %8s %8s\n", "scene", "map", "look", "r",
                "split", "mis", "cache", "x mis", "by p99", "seconds");
    for (const std::string& name : settings.scenes) {
        const auto set = loadSet(settings, name);
        const BakedCache baked = keptCache(settings, *set);
        for (const std::string& map : settings.maps) {
            const auto environment = loadMap(settings, map);
            const EstimatorContext context{*set->scene, *environment, baked.cache.get(), {}};
            const View view{context, *set, settings.frames.front(), std::max(1, settings.seeds)};
            for (const Look& look : looks())
                for (const Split& split : kSplits)
                    report(name, map, look, split, compare(view, look, split), json);
        }
    }
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
