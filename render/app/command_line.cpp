#include "render/app/command_line.h"

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "common/cli/command_line.h"
#include "render/frame/film.h"

namespace shadowcache {

namespace {

void defineScene(CLI::App& app, Arguments& arguments) {
    RenderJob& job = arguments.job;
    const std::string group = "Scene";
    app.add_option("SET", job.files,
                   "Files of the set: glTF, OBJ, PLY, STL, OFF or OM; several make one set")
        ->required()
        ->take_all();
    app.add_option("--env", job.environment,
                   "Lat-long map (EXR or HDR), or one radiance R,G,B; maps joined by commas, or a "
                   "sequence with ####: one for each frame")
        ->group(group);
    app.add_option(
           "--env-rotate", job.environmentRotation,
           "Degrees to turn the map about +Y, counter-clockwise from above; A-B: from A in the "
           "first frame to B in the last")
        ->capture_default_str()
        ->group(group);
    app.add_option("--dynamic", arguments.dynamic,
                   "FILE or FILE@TRACK.json: rendered and casts shadows, but is not in the cache")
        ->take_all()
        ->allow_extra_args(false)
        ->group(group);
    app.add_flag("--list", arguments.list,
                 "Print the cameras, animations and sizes of a glTF set, and do nothing else")
        ->group(group);
    app.add_option("--albedo", arguments.albedo,
                   "Albedo where the set has no vertex colours: one value, or R,G,B, 0 to 1")
        ->capture_default_str()
        ->group(group);
    app.add_option("--up", arguments.up, "Up axis of the files: y or z")
        ->check(CLI::IsMember({"y", "z"}))
        ->capture_default_str()
        ->group(group);
    app.add_option("--scale", job.mesh.scale, "Metres per unit of the files, above 0")
        ->capture_default_str()
        ->group(group);
}

void defineCamera(CLI::App& app, Arguments& arguments) {
    RenderJob& job = arguments.job;
    const std::string group = "Camera";
    auto* camera = app.add_option("--camera", job.camera.name,
                                  "Camera move (JSON), or the name of a camera of a glTF set")
                       ->group(group);
    app.add_option("--frames", arguments.frames,
                   "Frames of the move: A, A-B, A-BxSTEP, joined by commas [1]")
        ->group(group);
    app.add_option("--fps", job.fps, "Frames a second of a glTF set's animations")
        ->capture_default_str()
        ->group(group);
    auto* eye = app.add_option("--eye", arguments.eye, "Place of the camera: X,Y,Z")
                    ->excludes(camera)
                    ->group(group);
    auto* target = app.add_option("--look-at", arguments.target, "What it looks at: X,Y,Z")
                       ->needs(eye)
                       ->group(group);
    eye->needs(target);
    app.add_option("--fov-y", job.camera.fovYDegrees,
                   "Vertical angle of view in degrees, 0.01 to 179, with --eye")
        ->needs(eye)
        ->capture_default_str()
        ->group(group);
    app.add_option("--size", arguments.size, "Picture in pixels: WxH")
        ->capture_default_str()
        ->group(group);
    app.add_option("--crop", arguments.crop,
                   "Render only this part of the picture: X,Y,WxH from the upper left pixel X,Y; "
                   "the same pixels as in the whole picture")
        ->group(group);
    app.add_option("--filter", arguments.filter,
                   "Pixel filter of several camera rays: box, gaussian or blackman-harris")
        ->check(CLI::IsMember(filterNames()))
        ->capture_default_str()
        ->group(group);
    app.add_option("--filter-width", job.render.filterWidth,
                   "Its width in pixels as in Blender; 0: 1 for the box, 1.5 for the others")
        ->capture_default_str()
        ->group(group);
}

void definePaper(CLI::App& app, Arguments& arguments) {
    EstimatorOptions& options = arguments.job.estimatorOptions;
    const std::string paper = "Estimators `paper` and `paper-image`";
    app.add_option("--triangles", options.paper.triangles, "M, triangles of the map, 20 to 100000")
        ->capture_default_str()
        ->group(paper);
    app.add_option("--alpha", options.paper.alpha, "Trust in the cache, 0 to below 1")
        ->capture_default_str()
        ->group(paper);
    app.add_option("--threshold", options.paper.threshold,
                   "Fewest pooled rays of a region that count")
        ->capture_default_str()
        ->group(paper);
    app.add_option("--max-level", options.paper.maxLevel, "Finest level of the triangles, to 7")
        ->capture_default_str()
        ->group(paper);
    app.add_option("--order", options.paper.order, "Importance in a triangle: 0 constant, 1 linear")
        ->capture_default_str()
        ->group(paper);
    app.add_option("--beta", options.paper.beta,
                   "Share of samples uniform over the hemisphere, 0 to 1")
        ->capture_default_str()
        ->group(paper);
    app.add_option("--convolution", arguments.convolution,
                   "table: convolutions between 32 x 64 tabulated normals; exact: at the normal")
        ->check(CLI::IsMember({"table", "exact"}))
        ->capture_default_str()
        ->group(paper);
    app.add_option("--cache-level", options.paper.cacheLevel,
                   "Finest level of the counts it uses, 0 to 7")
        ->capture_default_str()
        ->group(paper);
    const std::string others = "Estimators `lights` and `pixel`";
    app.add_option("--lights", options.lights.lights, "K, directional lights, 1 to 10000")
        ->capture_default_str()
        ->group(others);
    app.add_option("--pixel-map", arguments.pixelMap, "Low-resolution map: WxH, 8x4 to 4096x2048")
        ->capture_default_str()
        ->group(others);
}

void defineEstimator(CLI::App& app, Arguments& arguments) {
    RenderJob& job = arguments.job;
    const std::string group = "Estimator";
    std::string names, choices;
    for (const EstimatorEntry& entry : estimatorTable()) {
        names += std::string("\n  ") + entry.name + ": " + entry.summary +
                 (entry.bias ? " (biased)" : "");
        choices += (choices.empty() ? "" : ",") + std::string(entry.name);
    }
    app.add_option("--estimator", job.estimator, "How the light is estimated:" + names)
        ->type_name("NAME:{" + choices + "}")
        ->group(group);
    auto* cache = app.add_option("--cache", job.cache, "Cache of the set, from shadowcache-bake")
                      ->group(group);
    app.add_option(
           "--memory", arguments.memory,
           "Memory for the cache, as 4G or 512M: parts of its file are read when needed and "
           "dropped when not; the same picture, slower. Without it all is read at once")
        ->type_name("SIZE")
        ->needs(cache)
        ->group(group);
    app.add_flag("--stale-ok", job.staleOk, "Use a cache of another set: unbiased all the same")
        ->group(group);
    auto* samples =
        app.add_option("--samples", job.render.samples,
                       "Shadow rays per camera ray; 0 with `cache`: a biased, noise-free preview");
    samples->capture_default_str()->group(group);
    app.add_option("--target-error", job.targetError,
                   "Choose the samples of each frame so that its relMSE comes to about this, from "
                   "a pilot whose numbers the picture does not use")
        ->excludes(samples)
        ->group(group);
    app.add_option(
           "--budget", arguments.budget,
           "uniform: every camera ray has --samples; adaptive: that is the mean, and `cache` "
           "shares out by the noise it expects")
        ->check(CLI::IsMember({"uniform", "adaptive"}))
        ->capture_default_str()
        ->group(group);
    app.add_option("--camera-rays", job.render.cameraRays, "Camera rays per pixel (antialiasing)")
        ->capture_default_str()
        ->group(group);
    app.add_option("--seed", job.render.seed, "Seed of all random numbers")
        ->check(notNegative)
        ->capture_default_str()
        ->group(group);
    app.add_option("--sequence", arguments.sequence,
                   "Numbers: sobol (Owen-scrambled), random, larcher-xor or larcher-shift (the "
                   "radical inverse of Larcher and Pillichshammer, randomised)")
        ->check(CLI::IsMember(sequenceNames()))
        ->capture_default_str()
        ->group(group);
    definePaper(app, arguments);
}

void defineOutput(CLI::App& app, Arguments& arguments) {
    RenderJob& job = arguments.job;
    const std::string group = "Output";
    std::string aovs;
    for (const std::string& name : aovNames()) aovs += " " + name;
    app.add_option("-o,--output", job.output,
                   "EXR to write (.exr); #### or %04d becomes the frame's number")
        ->group(group);
    app.add_flag("--resume", job.resume,
                 "Keep frames that are complete and of these settings and files")
        ->group(group);
    app.add_option("--aov", job.aovs, "More channels, any of:" + aovs)
        ->delimiter(',')
        ->take_all()
        ->check(CLI::IsMember(aovNames()))
        ->group(group);
    app.add_flag("--half", job.half, "16-bit channels instead of 32-bit")->group(group);
    app.add_flag("--png", job.png,
                 "An sRGB PNG beside each EXR; of the AOVs openness, expected_noise, items and "
                 "misses one in false colour")
        ->group(group);
    app.add_option("--exposure", job.exposure, "Stops to brighten the PNG by")
        ->capture_default_str()
        ->group(group);
    app.add_option("--reference", job.reference,
                   "EXR to compare with; the relative error goes to standard output and --stats")
        ->group(group);
    app.add_option("--stats", job.stats, "Write what it took as JSON")->group(group);
    app.add_option("--debug", arguments.debug,
                   "Write nothing, but print how the pixel X,Y comes about")
        ->configurable(false)
        ->group(group);
    app.add_flag("--explain", job.explain,
                 "Write nothing, but say which estimator works on what, and what noise and time "
                 "to expect")
        ->configurable(false)
        ->group(group);
    app.add_option("--threads", job.threads, "Threads; 0: one a core")
        ->capture_default_str()
        ->group(group);
}

/// CLI11 would ask for these with --list, too.
void requireWhatRendersNeed(const Arguments& arguments) {
    const RenderJob& job = arguments.job;
    if (job.environment.empty()) throw CLI::RequiredError("--env");
    if (job.output.empty()) throw CLI::RequiredError("--output");
    if (job.camera.name.empty() && arguments.eye.empty())
        throw CLI::RequiredError("--camera, or --eye with --look-at,");
}

constexpr const char* kExamples =
    "Examples:\n"
    "  shadowcache-render room.obj --env sky.exr --cache room.vdb --eye 1,1.6,3 --look-at "
    "0,1,0 -o still.exr --png\n"
    "  shadowcache-render set.ply --env sun.hdr --cache set.vdb --camera move.json --frames "
    "1-24 -o shot.####.exr\n"
    "  shadowcache-render set.glb --env sky.####.exr --cache set.vdb --camera shot --frames "
    "1-240 --resume -o shot.####.exr\n"
    "  shadowcache-render set.ply --env 1,1,1 --eye 1,1,1 --look-at 0,0,0 --estimator mis "
    "--samples 256 -o a.exr\n"
    "  shadowcache-render --config shot.toml --explain";

}  // namespace

std::optional<int> parseArguments(int argc, char** argv, Arguments& arguments) {
    CLI::App app(
        "Renders a static set under an HDRI: unbiased direct light, with few shadow rays where a "
        "cache tells where they matter.",
        "shadowcache-render");
    beginCommandLine(app);
    defineScene(app, arguments);
    defineCamera(app, arguments);
    defineEstimator(app, arguments);
    defineOutput(app, arguments);
    app.footer(kExamples);
    const auto check = [&] {
        if (!arguments.list) requireWhatRendersNeed(arguments);
    };
    if (const auto status = parseCommandLine(app, argc, argv, check)) return status;
    arguments.job.settings = settingsOf(app);
    return std::nullopt;
}

}  // namespace shadowcache
