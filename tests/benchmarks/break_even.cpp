// From how many frames on the bake of a shot pays.

#include <fmt/core.h>
#include <sys/resource.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "tests/benchmarks/antialiased.h"
#include "tests/support/program_run.h"

namespace shadowcache::bench {

namespace {

/// What frames are delivered at; measured at wholeView() and scaled by the number of pixels.
constexpr int kWidth = 1920, kHeight = 1080;

/// Of all programs run so far, over the threads of one.
double processorSecondsOfPrograms() {
    rusage used{};
    getrusage(RUSAGE_CHILDREN, &used);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return (seconds(used.ru_utime) + seconds(used.ru_stime)) / threadCount();
}

/// The bake of one frame.
struct ShotBake {
    std::unique_ptr<ShadowCache> cache;
    double seconds = 0;  ///< of the processor, over the threads; reading the set is part of it
    double megabytes = 0;
};

ShotBake bakeShot(const Settings& settings, const Set& set, int frame) {
    const auto path =
        std::filesystem::absolute(settings.work) / fmt::format("{}-shot{}.vdb", set.name, frame);
    std::filesystem::create_directories(settings.work);
    const SetFiles files = setFiles(settings, set.name);
    const double start = processorSecondsOfPrograms();
    const test::ProgramRun run = test::runProgram(
        "bake",
        {std::filesystem::absolute(files.mesh), "--camera",
         std::filesystem::absolute(files.cameras), "--frames", std::to_string(frame), "--size",
         fmt::format("{}x{}", kWidth, kHeight), "--threads", std::to_string(threadCount()),
         "--progress", "none", "-o", path},
        settings.work);
    if (run.status != 0) throw Error("shadowcache-bake failed: " + run.err);
    ShotBake baked;
    baked.seconds = processorSecondsOfPrograms() - start;
    baked.megabytes = static_cast<double>(std::filesystem::file_size(path)) * 1e-6;
    baked.cache = std::make_unique<ShadowCache>(path);
    return baked;
}

/// Frames from which on bake + n cache < n mis, at equal error; infinite where a frame of `cache`
/// is no faster.
///
/// @param mis  seconds of a frame of `mis` with the error of one of `cache`
double breakEven(double bake, double cache, double mis) {
    return mis > cache ? bake / (mis - cache) : std::numeric_limits<double>::infinity();
}

/// Seconds until `mis` has an error, as error falls as 1 / samples: the least of all splits.
double secondsToReach(const std::vector<std::pair<Split, Measured>>& mis, double error,
                      double RelativeError::*kind) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [split, m] : mis) least = std::min(least, m.seconds * m.error.*kind / error);
    return least;
}

void compare(const Picture& picture, const ShotBake& baked, const Split& split, JsonFile& json) {
    const Measured cache = measure(picture, split, "cache");
    const auto mis = measureMis(picture, split.rays());
    const RenderOptions& small = picture.view.options;
    const double pixels = static_cast<double>(kWidth) * kHeight / (small.width * small.height);
    const double own = pixels * cache.seconds;
    const double byMean = pixels * secondsToReach(mis, cache.error.mean, &RelativeError::mean);
    const double byP99 = pixels * secondsToReach(mis, cache.error.p99, &RelativeError::p99);
    const double frames = breakEven(baked.seconds, own, byMean);
    const double framesByP99 = breakEven(baked.seconds, own, byP99);
    std::printf("%-9s %-14s %5d %6s %8.1f %8.1f %9.3g %8.1f %8.0f %8.2g %8.0f %8.2g\n",
                picture.frame.set.name.c_str(), picture.frame.map.c_str(), picture.frame.number,
                split.name().c_str(), baked.seconds, baked.megabytes, cache.error.mean, own, byMean,
                frames, byP99, framesByP99);
    std::fflush(stdout);
    const std::string key = picture.frame.key() + "." + split.name() + ".";
    json.set(key + "bake_seconds", baked.seconds);
    json.set(key + "bake_megabytes", baked.megabytes);
    json.set(key + "relmse", cache.error.mean);
    json.set(key + "p99", cache.error.p99);
    json.set(key + "cache_seconds", own);
    json.set(key + "mis_seconds", byMean);
    json.set(key + "mis_seconds_by_p99", byP99);
    // JSON has no infinity: 0 stands for never.
    json.set(key + "frames", std::isfinite(frames) ? frames : 0);
    json.set(key + "frames_by_p99", std::isfinite(framesByP99) ? framesByP99 : 0);
}

}  // namespace

void breakEven(const Settings& settings) {
    JsonFile json;
    std::printf("seconds: of the processor, over the threads; of frames at %dx%d\n", kWidth,
                kHeight);
    std::printf("%-9s %-14s %5s %6s %8s %8s %9s %8s %8s %8s %8s %8s\n", "scene", "map", "frame",
                "split", "bake, s", "MB", "relMSE", "cache, s", "mis, s", "frames", "by p99",
                "frames");
    const View view = wholeView();
    for (const std::string& sceneName : settings.scenes) {
        const auto set = loadSet(settings, sceneName);
        for (const int frame : settings.frames) {
            const ShotBake baked = bakeShot(settings, *set, frame);
            for (const std::string& mapName : settings.maps) {
                const auto environment = loadMap(settings, mapName);
                const EstimatorContext context{*set->scene, *environment, baked.cache.get(), {}};
                const Frame shown{context, *set, mapName, frame};
                const Reference reference = antialiasedReference(shown, view, settings.work);
                const int seeds = settings.seeds > 0 ? settings.seeds : settings.full ? 4 : 2;
                const Picture picture{shown, view, reference.image, seeds};
                for (const std::string& split : settings.splits)
                    compare(picture, baked, parseSplit(split), json);
            }
        }
    }
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
