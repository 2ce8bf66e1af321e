// Memory of the bake and of the render, by triangles and by items; the time to open a large cache.

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "common/base/process.h"
#include "scenes/sets.h"
#include "tests/benchmarks/bench.h"
#include "tests/benchmarks/programs.h"

namespace shadowcache::bench {

namespace {

constexpr double kMillion = 1e6;

/// One set, baked and rendered by the programs themselves.
struct Run {
    double triangles = 0, items = 0, blocks = 0, fileBytes = 0;
    double bakePeak = 0, renderPeak = 0;
    std::filesystem::path cache;
};

Run runScatter(const Settings& settings, std::int64_t triangles, double spacing) {
    const std::filesystem::path folder = std::filesystem::absolute(settings.work);
    std::filesystem::create_directories(folder);
    const std::filesystem::path set = folder / "scatter.ply";
    scenes::writeScatter(set, triangles);
    Run run;
    run.cache = folder / "scatter.vdb";
    std::string eye, target;
    const scenes::CameraKey key = scenes::scatterWalk(triangles)[0];
    for (int k = 0; k < 3; ++k) {
        eye += fmt::format("{}{:f}", k > 0 ? "," : "", key.position[k]);
        target += fmt::format("{}{:f}", k > 0 ? "," : "", key.target[k]);
    }
    const Stats baked =
        runForStats("bake", {set, "-o", run.cache, "--spacing", std::to_string(spacing)}, folder);
    const Stats rendered =
        runForStats("render",
                    {set, "--env", "1,1,1", "--cache", run.cache, "--eye", eye, "--look-at", target,
                     "--size", fmt::format("{}x{}", settings.width, settings.height), "--samples",
                     std::to_string(settings.samples), "-o", folder / "memory.exr"},
                    folder);
    run.triangles = baked.at("triangles");
    run.items = baked.at("cache.items");
    run.blocks = baked.at("cache.blocks");
    run.fileBytes = baked.at("cache.bytes");
    run.bakePeak = baked.at("peak_rss_bytes");
    run.renderPeak = rendered.at("peak_rss_bytes");
    std::printf("%12.2f %10.2f %10.2f %10.1f %10.1f %10.1f\n", run.triangles / kMillion,
                run.items / kMillion, run.blocks / kMillion, run.fileBytes / kMillion,
                run.bakePeak / kMillion, run.renderPeak / kMillion);
    std::fflush(stdout);
    return run;
}

/// peak = base + perTriangle * triangles + perItem * items, through three runs.
struct Plane {
    double perTriangle, perItem, base;
};
Plane planeThrough(const std::array<Run, 3>& runs, double Run::*peak) {
    const double t1 = runs[1].triangles - runs[0].triangles, i1 = runs[1].items - runs[0].items;
    const double t2 = runs[2].triangles - runs[0].triangles, i2 = runs[2].items - runs[0].items;
    const double p1 = runs[1].*peak - runs[0].*peak, p2 = runs[2].*peak - runs[0].*peak;
    const double determinant = t1 * i2 - t2 * i1;
    Plane plane{};
    plane.perTriangle = (p1 * i2 - p2 * i1) / determinant;
    plane.perItem = (t1 * p2 - t2 * p1) / determinant;
    plane.base =
        runs[0].*peak - plane.perTriangle * runs[0].triangles - plane.perItem * runs[0].items;
    return plane;
}

void storePlane(const char* name, const Plane& plane, JsonFile& json) {
    std::printf("%s: %.0f MB + %.0f MB a million triangles + %.0f MB a million items\n", name,
                plane.base / kMillion, plane.perTriangle, plane.perItem);
    json.set(std::string(name) + ".base_bytes", plane.base);
    json.set(std::string(name) + ".bytes_per_triangle", plane.perTriangle);
    json.set(std::string(name) + ".bytes_per_item", plane.perItem);
}

}  // namespace

void memory(const Settings& settings) {
    JsonFile json;
    std::printf(
        "Peak memory of the programs on scattered rocks and grass, in millions\n"
        "%12s %10s %10s %10s %10s %10s\n",
        "triangles", "items", "blocks", "file MB", "bake MB", "render MB");
    std::array<Run, 3> runs;
    runs[0] = runScatter(settings, 250'000, 0.5);
    runs[1] = runScatter(settings, 3'000'000, 0.5);
    runs[2] = runScatter(settings, 500'000, 0.07);
    storePlane("bake", planeThrough(runs, &Run::bakePeak), json);
    storePlane("render", planeThrough(runs, &Run::renderPeak), json);

    const double start = secondsNow();
    const ShadowCache cache(runs[2].cache);
    const double seconds = secondsNow() - start;
    std::printf("a cache of %.2f million items, %.1f MB: opened in %.2f s, %.1f MB in memory\n",
                static_cast<double>(cache.itemCount()) / kMillion, runs[2].fileBytes / kMillion,
                seconds, static_cast<double>(cache.memoryBytes()) / kMillion);
    json.set("open.items", std::uint64_t{cache.itemCount()});
    json.set("open.blocks", std::uint64_t{cache.blockCount()});
    json.set("open.file_bytes", runs[2].fileBytes);
    json.set("open.memory_bytes", std::uint64_t{cache.memoryBytes()});
    json.set("open.seconds", seconds);
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
