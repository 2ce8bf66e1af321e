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

void measure(const Frame& frame, const Settings& settings, JsonFile& json) {
    RenderOptions best = largePicture();
    best.cameraRays = 256;  // of each half: edges rule the error of a preview
    best.samples = 1;
    const Reference reference = makeReference(frame.context, frame.set, frame.number, best,
                                              settings.work, frame.key() + ".preview");
    for (const Row& row : kRows) {
        const Rendered rendered = renderWith(frame.context, frame.set, row.estimator, frame.number,
                                             optionsOf(row, largePicture()));
        const RelativeError error = relativeError(rendered.image, reference.image);
        const double pixels = static_cast<double>(rendered.image.pixels.size());
        const double rays = static_cast<double>(rendered.stats.shadowRays) / pixels;
        const double microseconds = rendered.processorSeconds / pixels * 1e6;
        std::printf("%-8s %-22s %5d %-13s %9.2f %9.2f %9.2f %8.1f %9.2f\n", frame.set.name.c_str(),
                    frame.map.c_str(), frame.number, row.name, 100 * std::sqrt(error.mean),
                    100 * std::sqrt(error.p50), 100 * std::sqrt(error.p99), rays, microseconds);
        std::fflush(stdout);
        const std::string key = frame.key() + "." + row.name;
        json.set(key + ".relative_rmse", std::sqrt(error.mean));
        json.set(key + ".p50", std::sqrt(error.p50));
        json.set(key + ".p99", std::sqrt(error.p99));
        json.set(key + ".rays", rays);
        json.set(key + ".microseconds_a_pixel", microseconds);
    }
    std::printf("%-8s %-22s %5d relative RMSE of the reference itself: %.2f %%\n",
                frame.set.name.c_str(), frame.map.c_str(), frame.number,
                100 * std::sqrt(reference.ownError));
}

/// Seconds of a viewport's picture.
void measureViewport(const Frame& frame, const Settings& settings, JsonFile& json) {
    for (const Row& row : kRows) {
        if (!row.preview || row.cameraRays > 4) continue;
        double least = 0;
        for (int i = 0; i < settings.repeats; ++i) {
            const Rendered rendered = renderWith(frame.context, frame.set, row.estimator,
                                                 frame.number, optionsOf(row, RenderOptions()));
            if (i == 0 || rendered.stats.seconds < least) least = rendered.stats.seconds;
        }
        std::printf("%-8s %-22s %5d %-13s 960x540: %.2f s\n", frame.set.name.c_str(),
                    frame.map.c_str(), frame.number, row.name, least);
        json.set(frame.key() + "." + row.name + ".seconds_960x540", least);
    }
}

}  // namespace

void preview(const Settings& settings) {
    JsonFile json;
    std::printf("relative RMSE in %%; us/pixel: processor time over the threads\n");
    std::printf("%-8s %-22s %5s %-13s %9s %9s %9s %8s %9s\n", "scene", "map", "frame", "picture",
                "RMSE", "median", "p99", "rays/pix", "us/pixel");
    forEachFrame(settings, [&](const Frame& frame) {
        measure(frame, settings, json);
        measureViewport(frame, settings, json);
    });
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
