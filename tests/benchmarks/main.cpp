#include <CLI/CLI.hpp>
#include <exception>

#include "common/base/exit_status.h"
#include "common/base/progress.h"
#include "common/base/report_failure.h"
#include "tests/benchmarks/bench.h"

int main(int argc, char** argv) try {
    using namespace shadowcache;
    CLI::App app("Measures Shadowcache on real scenes and maps.", "shadowcache-bench");
    bench::Settings settings;
    app.add_option("--data", settings.data, "Folder with scene/, env/ and reference/");
    app.add_option("--work", settings.work, "Where caches and references go")
        ->capture_default_str();
    app.add_option("--scenes", settings.scenes, "Scenes")->delimiter(',')->capture_default_str();
    app.add_option("--maps", settings.maps, "Maps")->delimiter(',')->capture_default_str();
    app.add_option("--frames", settings.frames, "Camera frames")
        ->delimiter(',')
        ->capture_default_str();
    app.add_option("--samples", settings.samples, "Samples a pixel")->capture_default_str();
    app.add_option("--repeats", settings.repeats, "Renders to average over")->capture_default_str();
    app.add_option("--splits", settings.splits,
                   "delivered, break-even: camera rays x samples of each, joined by commas")
        ->delimiter(',')
        ->capture_default_str();
    app.add_option("--seeds", settings.seeds,
                   "delivered, bounces, break-even, gloss: renders to average over; 0: 2, with "
                   "--full 4, or 1 for gloss")
        ->capture_default_str();
    app.add_flag("!--no-crop", settings.crop, "delivered: no parts of large pictures");
    app.add_option("--spacing", settings.bake.spacing, "Spacing of the bake");
    app.add_option("--level", settings.bake.level, "Level of the bake")->capture_default_str();
    app.add_option("--rays", settings.bake.rays, "Rays of the bake")->capture_default_str();
    app.add_option("--json", settings.json, "Write the table as JSON");
    app.add_flag(
        "--full", settings.full,
        "efficiency, delivered, bounces: six maps and two frames; scaling: up to ten million items "
        "and triangles");
    void (*chosen)(const bench::Settings&) = nullptr;
    const auto add = [&](const char* name, const char* summary, auto benchmark) {
        app.add_subcommand(name, summary)->callback([&chosen, benchmark] { chosen = benchmark; });
    };
    add("efficiency", "Error and time of the estimators", bench::efficiency);
    add("delivered", "Error and time of antialiased pictures", bench::delivered);
    add("bounces", "Error and time of pictures with four bounces, over Cycles and brute force",
        bench::bounces);
    add("gloss", "Noise of glossy pictures by roughness, metal and varnish", bench::gloss);
    add("break-even", "Frames from which on the bake of a shot pays", bench::breakEven);
    add("bake", "Rays a second of the bake against bare Embree calls", bench::bakeSpeed);
    add("time", "Where the time of a render goes: Embree, set-up, the rest", bench::timeShares);
    add("memory", "Peak memory by triangles and items; opening a large cache", bench::memory);
    add("cycles", "Our pictures against those of Blender Cycles (kitchen, atrium)", bench::cycles);
    add("over-cycles", "Noise and seconds of antialiased pictures against Blender Cycles",
        bench::overCycles);
    add("scaling", "Time per pixel as items and triangles grow", bench::scaling);
    add("trade", "Error against the cost of spacing, level, rays and samples (first map)",
        bench::trade);
    add("oracle", "Noise with the baked cache against counts traced at the point", bench::oracle);
    add("sequences", "What well-spread samples gain over random numbers", bench::sequences);
    add("flicker", "Variance of what stays in view over 24 frames of a slow move", bench::flicker);
    add("map-turns", "Seconds to read, tabulate and turn maps of 1k to 8k", bench::mapTurns);
    add("preview", "Error and time of --preview at 1920x1080 (a part) and 960x540", bench::preview);
    app.require_subcommand(1, 1);
    app.fallthrough();
    installInterruptHandler();
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        return app.exit(e) == 0 ? kDone : kWrongUsage;
    }
    chosen(settings);
    return kDone;
} catch (const std::exception& e) {
    return shadowcache::reportFailure("shadowcache-bench", e);
}
