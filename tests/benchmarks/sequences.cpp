// What well-spread samples gain over random numbers, for each estimator.

#include <cstdio>

#include "tests/benchmarks/bench.h"

namespace shadowcache::bench {

void sequences(const Settings& settings) {
    JsonFile json;
    std::printf("%-9s %-13s %-12s %12s %12s %7s\n", "scene", "map", "estimator", "random", "Sobol",
                "ratio");
    for (const std::string& name : settings.scenes) {
        const auto set = loadSet(settings, name);
        const BakedCache baked = bakeCache(settings, *set, settings.bake, "sequences");
        for (const std::string& map : settings.maps) {
            const auto environment = loadMap(settings, map);
            EstimatorContext context{*set->scene, *environment, baked.cache.get(), {}};
            const Image reference =
                makeReference(context, *set, 1, 1024, settings, name + "." + map + "-sequences")
                    .image;
            for (const char* estimator : {"cosine", "environment", "mis", "paper", "cache"}) {
                double error[2] = {0, 0};
                for (const Sequence sequence : {Sequence::kRandom, Sequence::kSobol}) {
                    context.sequence = sequence;
                    for (int i = 1; i <= settings.repeats; ++i)
                        error[sequence == Sequence::kSobol] +=
                            relativeError(renderFrame(context, *set, estimator, 1, settings.samples,
                                                      static_cast<std::uint64_t>(i), settings)
                                              .image,
                                          reference)
                                .mean /
                            settings.repeats;
                }
                std::printf("%-9s %-13s %-12s %12.4g %12.4g %7.2f\n", name.c_str(), map.c_str(),
                            estimator, error[0], error[1], error[0] / error[1]);
                std::fflush(stdout);
                const std::string key = name + "." + map + "." + estimator;
                json.set(key + ".random", error[0]);
                json.set(key + ".sobol", error[1]);
            }
        }
    }
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
