// Error and time of the estimators at equal samples, on real scenes under real maps.

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/benchmarks/bench.h"

namespace shadowcache::bench {

namespace {

struct Measured {
    RelativeError error;
    double seconds = 0;
    double setup = 0;
    double trace = 0;
    double rays = 0;
    double efficiency() const { return 1 / (error.mean * seconds); }
};

/// Error averaged over seeds, and the median time.
Measured measure(const EstimatorContext& context, const Set& set, const std::string& estimator,
                 int frame, int samples, const Image& reference, const Settings& settings) {
    Measured m;
    std::vector<double> seconds;
    for (int i = 0; i < settings.repeats; ++i) {
        const Rendered r = renderFrame(context, set, estimator, frame, samples,
                                       static_cast<std::uint64_t>(i) + 1, settings);
        const RelativeError e = relativeError(r.image, reference);
        const double share = 1.0 / settings.repeats;
        m.error.mean += e.mean * share;
        m.error.p50 += e.p50 * share;
        m.error.p99 += e.p99 * share;
        m.error.max = std::max(m.error.max, e.max);
        m.setup += r.stats.setupSeconds * share;
        m.trace += r.stats.traceSeconds * share;
        m.rays += static_cast<double>(r.stats.shadowRays) * share;
        seconds.push_back(r.stats.seconds);
    }
    std::nth_element(seconds.begin(), seconds.begin() + settings.repeats / 2, seconds.end());
    m.seconds = seconds[static_cast<std::size_t>(settings.repeats / 2)];
    return m;
}

void store(JsonFile& json, const std::string& key, const Measured& m) {
    json.set(key + ".relmse", m.error.mean);
    json.set(key + ".p50", m.error.p50);
    json.set(key + ".p99", m.error.p99);
    json.set(key + ".max", m.error.max);
    json.set(key + ".seconds", m.seconds);
    json.set(key + ".setup_seconds", m.setup);
    json.set(key + ".trace_seconds", m.trace);
}

}  // namespace

void efficiency(const Settings& settings) {
    JsonFile json;
    double logVsMis = 0, logVsPaper = 0;
    int count = 0;
    std::printf(
        "%-10s %-14s %5s | %9s %7s %8s | %9s %7s %8s | %9s %7s %8s %8s %6s | %8s | %6s %6s | %7s\n",
        "scene", "map", "frame", "mis relMSE", "s", "p99", "paper", "s", "p99", "cache", "s", "p99",
        "max", "setup", "0 rays", "/mis", "/paper", "ref/err");
    for (const std::string& sceneName : settings.scenes) {
        const auto set = loadSet(settings, sceneName);
        const BakedCache baked = bakeCache(settings, *set, settings.bake, "adaptive");
        const double items = static_cast<double>(baked.cache->itemCount());
        std::printf(
            "%s: %zu triangles, spacing %g, %.0f items, bake %.1f s, %.0f rays/item, file %.0f "
            "bytes/item, memory %.0f bytes/item\n",
            sceneName.c_str(), set->mesh.triangles.size(), baked.cache->header().spacing, items,
            baked.seconds, baked.rays / items, baked.fileBytes / items,
            static_cast<double>(baked.cache->memoryBytes()) / items);
        json.set(sceneName + ".bake.seconds", baked.seconds);
        json.set(sceneName + ".bake.rays", baked.rays);
        json.set(sceneName + ".bake.items", items);
        json.set(sceneName + ".bake.file_bytes", baked.fileBytes);
        for (const std::string& mapName : settings.maps) {
            const auto environment = loadMap(settings, mapName);
            const EstimatorContext context{*set->scene, *environment, baked.cache.get(), {}};
            for (const int frame : settings.frames) {
                const std::string tag = sceneName + "-" + mapName + "-" + std::to_string(frame);
                const Reference reference =
                    makeReference(context, *set, frame, 4096, settings, tag);
                const Measured mis = measure(context, *set, "mis", frame, settings.samples,
                                             reference.image, settings);
                const Measured paper = measure(context, *set, "paper", frame, settings.samples,
                                               reference.image, settings);
                const Measured cache = measure(context, *set, "cache", frame, settings.samples,
                                               reference.image, settings);
                const Measured preview =
                    measure(context, *set, "cache", frame, 0, reference.image, settings);
                const double vsMis = cache.efficiency() / mis.efficiency();
                const double vsPaper = cache.efficiency() / paper.efficiency();
                // Set-up in shadow rays: the zero-ray render against the time of one ray.
                const double setupRays =
                    preview.seconds / (mis.trace / mis.rays) / (settings.width * settings.height);
                std::printf(
                    "%-10s %-14s %5d | %9.4g %7.3f %8.3g | %9.4g %7.3f %8.3g | %9.4g %7.3f %8.3g "
                    "%8.3g %6.1f | %8.3g | %6.1f %6.1f | %7.1g\n",
                    sceneName.c_str(), mapName.c_str(), frame, mis.error.mean, mis.seconds,
                    mis.error.p99, paper.error.mean, paper.seconds, paper.error.p99,
                    cache.error.mean, cache.seconds, cache.error.p99, cache.error.max, setupRays,
                    std::sqrt(preview.error.mean), vsMis, vsPaper,
                    reference.ownError / cache.error.mean);
                std::fflush(stdout);
                const std::string key =
                    sceneName + "." + mapName + ".frame" + std::to_string(frame);
                store(json, key + ".mis", mis);
                store(json, key + ".paper", paper);
                store(json, key + ".cache", cache);
                store(json, key + ".preview", preview);
                json.set(key + ".vs_mis", vsMis);
                json.set(key + ".vs_paper", vsPaper);
                json.set(key + ".reference_error", reference.ownError);
                logVsMis += std::log(vsMis);
                logVsPaper += std::log(vsPaper);
                ++count;
            }
        }
    }
    std::printf("geometric mean: %.1f times mis, %.1f times paper\n", std::exp(logVsMis / count),
                std::exp(logVsPaper / count));
    json.set("geometric_mean.vs_mis", std::exp(logVsMis / count));
    json.set("geometric_mean.vs_paper", std::exp(logVsPaper / count));
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
