// How much the same places of a set flicker over the frames of a slow move, by estimator.

#include "tests/support/flicker.h"

#include <cstdio>
#include <numeric>

#include "tests/benchmarks/bench.h"

namespace shadowcache::bench {

namespace {

constexpr int kFrames = 24;
constexpr int kReferenceSamples = 8;  ///< times those of what is judged

struct Row {
    const char* name;
    const char* estimator;
    bool adaptive;
    int samples = 0;  ///< 0: those of the settings
    bool preview = false;
};
constexpr Row kRows[] = {{"mis", "mis", false},           {"paper", "paper", false},
                         {"cache", "cache", false},       {"cache-adaptive", "cache", true},
                         {"4 samples", "cache", true, 4}, {"preview of 4", "cache", true, 4, true}};

double meanOf(const std::vector<double>& values) {
    return std::reduce(values.begin(), values.end()) / static_cast<double>(values.size());
}

/// One set under one map: a line for each estimator, and one for the control.
void measure(const Set& set, const std::string& mapName, const Environment& environment,
             const ShadowCache* cache, const Settings& settings, JsonFile& json) {
    RenderOptions options;
    options.width = settings.width;
    options.height = settings.height;
    options.samples = settings.samples;
    std::vector<int> numbers(kFrames);
    std::iota(numbers.begin(), numbers.end(), settings.frames.front());
    std::vector<Camera> cameras;
    for (const int frame : numbers) cameras.push_back(cameraAtFrame(set.cameras, frame));

    const EstimatorContext context{*set.scene, environment, cache, {}};
    const test::Places places = test::trackPlaces(context, cameras, options);
    const test::Places pixels = test::samePixels(places);
    RenderOptions best = options;
    best.samples *= kReferenceSamples;
    best.seed = 1001;
    RenderStats unused;
    const test::ShotLight reference =
        test::renderShot(context, "cache", cameras, numbers, best, unused);
    const std::vector<double> brightness = test::brightness(reference, places);

    double ofMis = 0;
    const auto measureOne = [&](const Row& row, const std::vector<int>& frames) {
        RenderStats stats;
        RenderOptions asked = options;
        if (row.samples > 0) asked.samples = row.samples;
        asked.preview = row.preview;
        EstimatorOptions estimatorOptions;
        estimatorOptions.cache.adaptive = row.adaptive;
        const test::ShotLight shot = test::renderShot(context, row.estimator, cameras, frames,
                                                      asked, stats, estimatorOptions);
        const test::ShotLight errors = test::errorsOf(shot, reference);
        const double variance = test::temporalVariance(shot, places, brightness);
        const double noise = test::temporalVariance(errors, places, brightness);
        const double place = meanOf(test::correlations(errors, places, brightness));
        const double pixel = meanOf(test::correlations(errors, pixels, brightness));
        const double rays = static_cast<double>(stats.shadowRays) /
                            (kFrames * static_cast<double>(options.width) * options.height);
        if (ofMis == 0) ofMis = noise;
        std::printf("%-9s %-13s %-15s %8.1f %10.4g %10.4g %8.1f %9.3f %9.3f\n", set.name.c_str(),
                    mapName.c_str(), row.name, rays, variance, noise, ofMis / noise, place, pixel);
        std::fflush(stdout);
        const std::string key = set.name + "." + mapName + "." + row.name;
        json.set(key + ".rays_per_pixel", rays);
        json.set(key + ".variance", variance);
        json.set(key + ".noise", noise);
        json.set(key + ".correlation_at_place", place);
        json.set(key + ".correlation_at_pixel", pixel);
    };
    for (const Row& row : kRows) {
        measureOne(row, numbers);
    }
    // Control: numbers that are the same in every frame stick to the screen.
    const std::vector<int> stuck(kFrames, numbers.front());
    measureOne({"stuck numbers", "cache", true}, stuck);
    const double move = test::temporalVariance(reference, places, brightness);
    std::printf("%-9s %-13s %-15s %8s %10.4g          (%zu places)\n", set.name.c_str(),
                mapName.c_str(), "reference", "", move, places.count());
    json.set(set.name + "." + mapName + ".reference.variance", move);
}

}  // namespace

void flicker(const Settings& settings) {
    std::printf("%d frames from %d, %dx%d, %d samples; the reference has %d times as many\n",
                kFrames, settings.frames.front(), settings.width, settings.height, settings.samples,
                kReferenceSamples);
    std::printf("%-9s %-13s %-15s %8s %10s %10s %8s %9s %9s\n", "scene", "map", "estimator",
                "rays/pix", "variance", "of noise", "mis / it", "r, place", "r, pixel");
    JsonFile json;
    for (const std::string& name : settings.scenes) {
        const auto set = loadSet(settings, name);
        const BakedCache baked = bakeCache(settings, *set, settings.bake, "flicker");
        for (const std::string& map : settings.maps)
            measure(*set, map, *loadMap(settings, map), baked.cache.get(), settings, json);
    }
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
