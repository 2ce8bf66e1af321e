// Where the time of a render goes: Embree, the estimator's set-up, the rest.

#include <algorithm>
#include <cstdio>

#include "common/base/parallel.h"
#include "render/table/estimator_table.h"
#include "tests/benchmarks/bench.h"
#include "tests/benchmarks/embree_spy.h"

namespace shadowcache::bench {

namespace {

struct Shares {
    double seconds = 0;  ///< unwatched
    double embree = 0, setup = 0;
    double rest() const { return 1 - embree - setup; }
};

Shares measure(const EstimatorContext& context, const Set& set, const std::string& estimator,
               int frame, const Settings& settings) {
    std::vector<double> seconds;
    for (int i = 0; i < settings.repeats; ++i)
        seconds.push_back(renderFrame(context, set, estimator, frame, settings.samples, 1, settings)
                              .stats.seconds);
    std::nth_element(seconds.begin(), seconds.begin() + settings.repeats / 2, seconds.end());

    spy(Spying::time);
    const RenderStats watched =
        renderFrame(context, set, estimator, frame, settings.samples, 1, settings).stats;
    const Spied spied = endSpying();
    Shares shares;
    shares.seconds = seconds[static_cast<std::size_t>(settings.repeats / 2)];
    shares.embree = spied.seconds / threadCount() / watched.seconds;
    shares.setup = watched.setupSeconds / watched.seconds;
    return shares;
}

}  // namespace

void timeShares(const Settings& settings) {
    JsonFile json;
    std::printf("%d samples, %dx%d, %d threads; the rest is shading, film and idle threads\n",
                settings.samples, settings.width, settings.height, threadCount());
    std::printf("%-9s %-13s %-12s %8s %8s %8s %8s %8s\n", "scene", "map", "estimator", "seconds",
                "x mis", "Embree", "set-up", "rest");
    for (const std::string& sceneName : settings.scenes) {
        const auto set = loadSet(settings, sceneName);
        const BakedCache baked = bakeCache(settings, *set, settings.bake, "adaptive");
        for (const std::string& mapName : settings.maps) {
            const auto environment = loadMap(settings, mapName);
            const EstimatorContext context{*set->scene, *environment, baked.cache.get(), {}};
            const double mis = measure(context, *set, "mis", settings.frames[0], settings).seconds;
            for (const EstimatorEntry& entry : estimatorTable()) {
                const Shares s = measure(context, *set, entry.name, settings.frames[0], settings);
                std::printf("%-9s %-13s %-12s %8.3f %8.2f %7.0f%% %7.0f%% %7.0f%%\n",
                            sceneName.c_str(), mapName.c_str(), entry.name, s.seconds,
                            s.seconds / mis, 100 * s.embree, 100 * s.setup, 100 * s.rest());
                std::fflush(stdout);
                const std::string key = sceneName + "." + mapName + "." + entry.name;
                json.set(key + ".seconds", s.seconds);
                json.set(key + ".share.embree", s.embree);
                json.set(key + ".share.setup", s.setup);
                json.set(key + ".share.rest", s.rest());
            }
        }
    }
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
