// Error and time of the estimators at equal samples, on real scenes under real maps.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "tests/benchmarks/bench.h"
#include "tests/benchmarks/deviation.h"

namespace shadowcache::bench {

namespace {

/// Samples of each half of a reference.
constexpr int kReferenceSamples = 4096;

/// The control: a reference so much brighter must be told from the true one.
constexpr double kControl = 1.02;

struct Measured {
    RelativeError error;
    double seconds = 0;
    double setup = 0;
    double trace = 0;
    double rays = 0;
    Deviation fromReference, fromBrighter;
    double efficiency() const { return 1 / (error.mean * seconds); }
};

/// What is compared; efficiencies are against the first.
struct Column {
    const char* name;
    const char* estimator;
    bool adaptive;
    bool preview;
};
constexpr Column kColumns[] = {{"mis", "mis", false, false},
                               {"paper", "paper", false, false},
                               {"cache", "cache", false, false},
                               {"cache-adaptive", "cache", true, false},
                               {"preview", "cache", false, true}};
constexpr std::size_t kMis = 0, kPaper = 1, kUniform = 2, kAdaptive = 3, kColumnCount = 5;

/// Error averaged over seeds, and the median time.
Measured measure(const EstimatorContext& context, const Set& set, const Column& column, int frame,
                 const Image& reference, const Settings& settings) {
    Measured m;
    EstimatorOptions options;
    options.cache.adaptive = column.adaptive;
    std::vector<double> seconds;
    for (int i = 0; i < settings.repeats; ++i) {
        const Rendered r = renderFrame(context, set, column.estimator, frame,
                                       column.preview ? 0 : settings.samples,
                                       static_cast<std::uint64_t>(i) + 1, settings, options);
        const RelativeError e = relativeError(r.image, reference);
        m.fromReference.add(r.image, reference, 1);
        m.fromBrighter.add(r.image, reference, kControl);
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

/// Geometric means over all combinations.
struct Summary {
    double vsMis = 0, adaptiveVsMis = 0, vsPaper = 0;
    int count = 0;
};

void compare(const EstimatorContext& context, const Set& set, const std::string& map, int frame,
             const Settings& settings, JsonFile& json, Summary& summary) {
    const std::string key = fmt::format("{}.{}.frame{}", set.name, map, frame);
    const Reference reference =
        makeReference(context, set, frame, kReferenceSamples, settings, key);
    std::array<Measured, kColumnCount> m;
    for (std::size_t i = 0; i < m.size(); ++i) {
        m[i] = measure(context, set, kColumns[i], frame, reference.image, settings);
        std::printf("%-9s %-13s %5d %-15s %9.3g %9.3g %9.3g %9.3g %8.3f %8.3f %8.1f %8.1f\n",
                    set.name.c_str(), map.c_str(), frame, kColumns[i].name, m[i].error.mean,
                    m[i].error.p50, m[i].error.p99, m[i].error.max, m[i].seconds, m[i].setup,
                    m[i].efficiency() / m[kMis].efficiency(),
                    i >= kPaper ? m[i].efficiency() / m[kPaper].efficiency() : 0.0);
        std::fflush(stdout);
        store(json, key + "." + kColumns[i].name, m[i]);
    }
    // In shadow rays: the whole of the zero-ray render, and the set-up of the one with samples.
    const double perRay = m[kMis].trace / m[kMis].rays * (settings.width * settings.height);
    const double previewRays = m.back().seconds / perRay;
    const double setupRays = m[kUniform].setup / perRay;
    std::printf(
        "%-9s %-13s %5d a pixel of the preview costs %.1f shadow rays, the set-up for samples "
        "%.1f; "
        "preview's relative RMSE %.3g; error of the reference %.2g of that of `cache`\n",
        set.name.c_str(), map.c_str(), frame, previewRays, setupRays,
        std::sqrt(m.back().error.mean), reference.ownError / m[kUniform].error.mean);
    const Deviation& off = m[kMis].fromReference;
    const Deviation& control = m[kMis].fromBrighter;
    std::printf(
        "%-9s %-13s %5d mis over the reference (made with `cache`): %+.2f %%, %+.1f standard "
        "errors; over one 2 %% brighter: %+.1f\n",
        set.name.c_str(), map.c_str(), frame, 100 * off.mean(), off.significance(),
        control.significance());
    json.set(key + ".mis_over_reference", off.mean());
    json.set(key + ".mis_over_reference_standard_errors", off.significance());
    json.set(key + ".preview_rays", previewRays);
    json.set(key + ".setup_rays", setupRays);
    json.set(key + ".reference_error", reference.ownError);
    summary.vsMis += std::log(m[kUniform].efficiency() / m[kMis].efficiency());
    summary.adaptiveVsMis += std::log(m[kAdaptive].efficiency() / m[kMis].efficiency());
    summary.vsPaper += std::log(m[kUniform].efficiency() / m[kPaper].efficiency());
    ++summary.count;
}

void storeBake(const Set& set, const BakedCache& baked, JsonFile& json) {
    const auto items = static_cast<double>(baked.cache->itemCount());
    std::printf(
        "%s: %zu triangles, spacing %g, %.0f items, bake %.1f s, %.0f rays/item, file %.0f "
        "bytes/item, memory %.0f bytes/item\n",
        set.name.c_str(), set.mesh.triangles.size(), baked.cache->header().spacing, items,
        baked.seconds, baked.rays / items, baked.fileBytes / items,
        static_cast<double>(baked.cache->memoryBytes()) / items);
    json.set(set.name + ".bake.seconds", baked.seconds);
    json.set(set.name + ".bake.rays", baked.rays);
    json.set(set.name + ".bake.items", items);
    json.set(set.name + ".bake.file_bytes", baked.fileBytes);
}

}  // namespace

void efficiency(const Settings& chosen) {
    const Settings settings = chosen.full ? fullMatrix(chosen) : chosen;
    JsonFile json;
    Summary summary;
    std::printf("%-9s %-13s %5s %-15s %9s %9s %9s %9s %8s %8s %8s %8s\n", "scene", "map", "frame",
                "estimator", "relMSE", "p50", "p99", "max", "seconds", "set-up", "x mis",
                "x paper");
    for (const std::string& sceneName : settings.scenes) {
        const auto set = loadSet(settings, sceneName);
        const BakedCache baked = bakeCache(settings, *set, settings.bake, "adaptive");
        storeBake(*set, baked, json);
        for (const std::string& mapName : settings.maps) {
            const auto environment = loadMap(settings, mapName);
            const EstimatorContext context{*set->scene, *environment, baked.cache.get(), {}};
            for (const int frame : settings.frames)
                compare(context, *set, mapName, frame, settings, json, summary);
        }
    }
    const auto mean = [&](double logSum) { return std::exp(logSum / summary.count); };
    std::printf(
        "geometric mean: cache %.1f times mis and %.1f times paper, adaptive %.1f times "
        "mis\n",
        mean(summary.vsMis), mean(summary.vsPaper), mean(summary.adaptiveVsMis));
    json.set("geometric_mean.vs_mis", mean(summary.vsMis));
    json.set("geometric_mean.vs_paper", mean(summary.vsPaper));
    json.set("geometric_mean.adaptive_vs_mis", mean(summary.adaptiveVsMis));
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
