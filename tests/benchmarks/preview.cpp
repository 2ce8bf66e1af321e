// Error and time of previews, against antialiased references and against `mis`.

#include <cmath>
#include <cstdio>

#include "tests/benchmarks/bench.h"

namespace shadowcache::bench {

namespace {

/// The middle of a large picture, whose pixels are smaller than items.
RenderOptions largePicture() {
    RenderOptions options;
    options.width = 1920;
    options.height = 1080;
    options.crop = FilmRectangle{720, 405, 480, 270};
    return options;
}

/// What is measured of a picture.
struct Row {
    const char* name;
    const char* estimator;
    int cameraRays, samples;
    bool preview;
};
constexpr Row kRows[] = {
    {"mis 4x3", "mis", 4, 3, false},        {"mis 12x1", "mis", 12, 1, false},
    {"mis 16x16", "mis", 16, 16, false},    {"cache 4x0", "cache", 4, 0, false},
    {"cache 4x1", "cache", 4, 1, false},    {"preview 1x1", "cache", 1, 1, true},
    {"preview 4x1", "cache", 4, 1, true},   {"preview 8x1", "cache", 8, 1, true},
    {"preview 16x1", "cache", 16, 1, true}, {"preview 64x1", "cache", 64, 1, true}};

RenderOptions optionsOf(const Row& row, RenderOptions options) {
    options.cameraRays = row.cameraRays;
    options.samples = row.samples;
    options.preview = row.preview;
    return options;
}

void measure(const EstimatorContext& context, const Set& set, const std::string& map, int frame,
             const Settings& settings, JsonFile& json) {
    RenderOptions best = largePicture();
    best.cameraRays = 32;
    best.samples = 4;
    const std::string tag = set.name + "." + map + ".frame" + std::to_string(frame) + ".preview";
    const Reference reference = makeReference(context, set, frame, best, settings.work, tag);
    for (const Row& row : kRows) {
        const Rendered rendered =
            renderWith(context, set, row.estimator, frame, optionsOf(row, largePicture()));
        const RelativeError error = relativeError(rendered.image, reference.image);
        const double pixels = static_cast<double>(rendered.image.pixels.size());
        const double rays = static_cast<double>(rendered.stats.shadowRays) / pixels;
        const double microseconds = rendered.processorSeconds / pixels * 1e6;
        std::printf("%-8s %-22s %5d %-13s %9.2f %9.2f %9.2f %8.1f %9.2f\n", set.name.c_str(),
                    map.c_str(), frame, row.name, 100 * std::sqrt(error.mean),
                    100 * std::sqrt(error.p50), 100 * std::sqrt(error.p99), rays, microseconds);
        std::fflush(stdout);
        const std::string key =
            set.name + "." + map + ".frame" + std::to_string(frame) + "." + row.name;
        json.set(key + ".relative_rmse", std::sqrt(error.mean));
        json.set(key + ".p50", std::sqrt(error.p50));
        json.set(key + ".p99", std::sqrt(error.p99));
        json.set(key + ".rays", rays);
        json.set(key + ".microseconds_a_pixel", microseconds);
    }
    std::printf("%-8s %-22s %5d relative RMSE of the reference itself: %.2f %%\n", set.name.c_str(),
                map.c_str(), frame, 100 * std::sqrt(reference.ownError));
}

/// Seconds of a viewport's picture.
void measureViewport(const EstimatorContext& context, const Set& set, const std::string& map,
                     int frame, const Settings& settings, JsonFile& json) {
    for (const Row& row : kRows) {
        if (!row.preview || row.cameraRays > 4) continue;
        double least = 0;
        for (int i = 0; i < settings.repeats; ++i) {
            const Rendered rendered =
                renderWith(context, set, row.estimator, frame, optionsOf(row, RenderOptions()));
            if (i == 0 || rendered.stats.seconds < least) least = rendered.stats.seconds;
        }
        std::printf("%-8s %-22s %5d %-13s 960x540: %.2f s\n", set.name.c_str(), map.c_str(), frame,
                    row.name, least);
        json.set(set.name + "." + map + ".frame" + std::to_string(frame) + "." + row.name +
                     ".seconds_960x540",
                 least);
    }
}

}  // namespace

void preview(const Settings& settings) {
    JsonFile json;
    std::printf("relative RMSE in %%; us/pixel: processor time over the threads\n");
    std::printf("%-8s %-22s %5s %-13s %9s %9s %9s %8s %9s\n", "scene", "map", "frame", "picture",
                "RMSE", "median", "p99", "rays/pix", "us/pixel");
    for (const std::string& sceneName : settings.scenes) {
        const auto set = loadSet(settings, sceneName);
        const BakedCache baked = keptCache(settings, *set);
        for (const std::string& mapName : settings.maps) {
            const auto environment = loadMap(settings, mapName);
            const EstimatorContext context{*set->scene, *environment, baked.cache.get(), {}};
            for (const int frame : settings.frames) {
                measure(context, *set, mapName, frame, settings, json);
                measureViewport(context, *set, mapName, frame, settings, json);
            }
        }
    }
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
