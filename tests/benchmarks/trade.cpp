// The trade of speed for accuracy: error against what the bake and the render cost, for each thing
// a user can choose. docs/benchmarks/trade.md shows it as curves.

#include <fmt/core.h>

#include <cstdio>

#include "bake/core/default_spacing.h"
#include "common/base/process.h"
#include "tests/benchmarks/bench.h"

namespace shadowcache::bench {

namespace {

/// One choice, baked and rendered.
struct Variant {
    std::string series;
    double choice;
    BakeOptions bake;
};

std::vector<Variant> variants(const BakeOptions& usual) {
    std::vector<Variant> all;
    const auto vary = [&](const char* series, double choice, auto change) {
        all.push_back({series, choice, usual});
        change(all.back().bake);
    };
    for (const double factor : {2.8, 2.0, 1.4, 1.0, 0.7})
        vary("spacing", factor * usual.spacing, [&](BakeOptions& b) { b.spacing *= factor; });
    for (const int level : {1, 3, 5})
        vary("level", level, [&](BakeOptions& b) { b.level = level; });
    for (const int rays : {2, 4, 8, 16, 32})
        vary("rays", rays, [&](BakeOptions& b) { b.rays = rays; });
    for (const int level : {3, 4})
        vary("uniform", level, [&](BakeOptions& b) {
            b.adaptive = false;
            b.level = level;
        });
    // A uniform bake of the finest level takes minutes even at twice the spacing.
    for (const int level : {3, 4, 5})
        vary("uniform-coarse", level, [&](BakeOptions& b) {
            b.adaptive = false;
            b.level = level;
            b.spacing *= 2;
        });
    return all;
}

class Trade {
public:
    Trade(const Settings& settings, const Set& set, const Environment& environment,
          const std::string& map, JsonFile& json)
        : settings_(settings),
          set_(set),
          environment_(environment),
          key_(set.name + "." + map),
          json_(json) {
        BakeOptions usual = settings.bake;
        if (!(usual.spacing > 0)) usual.spacing = chooseSpacing(set.mesh);
        const BakedCache baked = bakeCache(settings, set, usual, "usual");
        reference_ =
            makeReference(context(*baked.cache), set, 1, 1024, settings, key_ + "-trade").image;
        std::printf("%s\n%-9s %9s %9s %9s %9s %11s %10s %9s %9s\n", key_.c_str(), "series",
                    "choice", "bake s", "M rays", "MB", "relMSE", "p99", "seconds", "preview");
        for (const Variant& v : variants(usual)) {
            const BakedCache other = bakeCache(settings, set, v.bake, "trade");
            add(v.series, v.choice, other, settings.samples, "cache");
        }
        for (const char* estimator : {"mis", "paper", "cache"})
            for (const int samples : {1, 4, 16, 64, 256})
                add(std::string("samples-") + estimator, samples, baked, samples, estimator);
    }

private:
    EstimatorContext context(const ShadowCache& cache) const {
        return {*set_.scene, environment_, &cache, {}};
    }

    void add(const std::string& series, double choice, const BakedCache& baked, int samples,
             const std::string& estimator) {
        RelativeError error;
        double seconds = 0;
        for (int i = 0; i < settings_.repeats; ++i) {
            const Rendered r = renderFrame(context(*baked.cache), set_, estimator, 1, samples,
                                           static_cast<std::uint64_t>(i) + 1, settings_);
            const RelativeError e = relativeError(r.image, reference_);
            error.mean += e.mean / settings_.repeats;
            error.p99 += e.p99 / settings_.repeats;
            seconds += r.stats.seconds / settings_.repeats;
        }
        const RelativeError preview = relativeError(
            renderFrame(context(*baked.cache), set_, "cache", 1, 0, 1, settings_).image,
            reference_);
        std::printf("%-13s %5.3g %9.2f %9.1f %9.1f %11.4g %10.4g %9.3f %9.3g\n", series.c_str(),
                    choice, baked.seconds, baked.rays * 1e-6, baked.fileBytes * 1e-6, error.mean,
                    error.p99, seconds, preview.mean);
        std::fflush(stdout);
        const std::string key = fmt::format("{}.{}.run{}", key_, series, points_++);
        json_.set(key + ".choice", choice);
        json_.set(key + ".bake_seconds", baked.seconds);
        json_.set(key + ".bake_rays", baked.rays);
        json_.set(key + ".file_bytes", baked.fileBytes);
        json_.set(key + ".memory_bytes", static_cast<double>(baked.cache->memoryBytes()));
        json_.set(key + ".items", static_cast<double>(baked.cache->itemCount()));
        json_.set(key + ".relmse", error.mean);
        json_.set(key + ".p99", error.p99);
        json_.set(key + ".seconds", seconds);
        json_.set(key + ".preview_relmse", preview.mean);
    }

    const Settings& settings_;
    const Set& set_;
    const Environment& environment_;
    std::string key_;
    JsonFile& json_;
    Image reference_;
    int points_ = 10;  // two digits, so that names sort
};

}  // namespace

void trade(const Settings& settings) {
    JsonFile json;
    for (const std::string& name : settings.scenes) {
        const auto set = loadSet(settings, name);
        const auto environment = loadMap(settings, settings.maps.front());
        Trade(settings, *set, *environment, settings.maps.front(), json);
    }
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
