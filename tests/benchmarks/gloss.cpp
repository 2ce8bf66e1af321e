// Noise of glossy pictures with a cache against `mis`, by roughness.

#include <algorithm>
#include <cstdio>

#include "tests/benchmarks/antialiased.h"

namespace shadowcache::bench {

namespace {

constexpr int kWidth = 160, kHeight = 90;

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

struct Noise {
    double error = 0, p99 = 0, seconds = 0;
};

/// Pictures of `cache` and of `mis`, against one of the same camera rays with more samples: what
/// remains is the noise of the light.
struct Both {
    Noise cache, mis;
};
Both compare(const Frame& frame, int seeds, const Look& look, const Split& split) {
    Both both;
    for (int seed = 1; seed <= seeds; ++seed) {
        RenderOptions options;
        options.width = kWidth;
        options.height = kHeight;
        options.seed = static_cast<std::uint64_t>(seed);
        options.plain.gloss = look.gloss;
        options.cameraRays = split.cameraRays;
        options.samples = split.samples * kReferenceSamples;
        const Image reference =
            renderWithSameRays(frame.context, frame.set, "cache", frame.number, options).image;
        options.samples = split.samples;
        const auto measure = [&](const char* estimator, Noise& m) {
            const Rendered r =
                renderWithSameRays(frame.context, frame.set, estimator, frame.number, options);
            const RelativeError e = relativeError(r.image, reference);
            m.error += e.mean / seeds;
            m.p99 += e.p99 / seeds;
            m.seconds = seed == 1 ? r.processorSeconds : std::min(m.seconds, r.processorSeconds);
        };
        measure("cache", both.cache);
        measure("mis", both.mis);
    }
    return both;
}

void report(const Frame& frame, const Look& look, const Split& split, const Both& both,
            JsonFile& json) {
    const double seconds = both.cache.seconds / both.mis.seconds;
    const double gain = both.mis.error / both.cache.error / seconds;
    const double byP99 = both.mis.p99 / both.cache.p99 / seconds;
    char roughness[16] = "";
    if (look.gloss)
        std::snprintf(roughness, sizeof roughness, "%.1f",
                      static_cast<double>(look.gloss->roughness));
    std::printf("%-9s %-14s %5d %-8s %4s %6s %9.3g %9.3g %8.2f %8.2f %8.2f\n",
                frame.set.name.c_str(), frame.map.c_str(), frame.number, look.name, roughness,
                split.name().c_str(), both.mis.error, both.cache.error, gain, byP99, seconds);
    std::fflush(stdout);
    // A dot in a key begins a level of the file.
    std::string name = look.name + std::string(roughness);
    std::erase(name, '.');
    const std::string key = frame.key() + "." + name + "." + split.name();
    json.set(key + ".relmse_mis", both.mis.error);
    json.set(key + ".relmse", both.cache.error);
    json.set(key + ".times_mis", gain);
    json.set(key + ".times_mis_by_p99", byP99);
    json.set(key + ".seconds_over_mis", seconds);
}

}  // namespace

void gloss(const Settings& settings) {
    JsonFile json;
    std::printf("%-9s %-14s %5s %-8s %4s %6s %9s %9s %8s %8s %8s\n", "scene", "map", "frame",
                "look", "r", "split", "mis", "cache", "x mis", "by p99", "seconds");
    forEachFrame(settings, [&](const Frame& frame) {
        for (const Look& look : looks())
            for (const Split& split : kSplits)
                report(frame, look, split, compare(frame, std::max(1, settings.seeds), look, split),
                       json);
    });
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
