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
    addSetOptions(app, job.files, arguments.up, job.mesh.scale, arguments.setFrame,
                  arguments.allowExternal, group);
    app.add_option(
           "--env", job.environment,
           "Lat-long map (EXR or HDR), or a constant radiance R,G,B; for one map per frame: maps "
           "joined by commas, or a sequence with ####")
        ->group(group);
    app.add_option("--env-rotate", job.environmentRotation,
                   "Rotation of the map about +Y in degrees, counter-clockwise seen from above; "
                   "A-B: from A in the first frame to B in the last")
        ->capture_default_str()
        ->group(group);
    app.add_option("--dynamic", arguments.dynamic,
                   "FILE or FILE@TRACK.json: a moving object, rendered but not part of the cache")
        ->take_all()
        ->allow_extra_args(false)
        ->group(group);
    app.add_flag("--list", arguments.list,
                 "Print cameras, animations and sizes of a glTF set, and exit")
        ->group(group);
    app.add_option("--normals", arguments.normals,
                   "shading: the files' normals, where they have some; geometric: each "
                   "triangle's own")
        ->check(CLI::IsMember({"shading", "geometric"}))
        ->capture_default_str()
        ->group(group);
    app.add_option("--smooth", job.mesh.smoothDegrees,
                   "Smooth triangles without shading normals where neighbours differ by at most "
                   "DEGREES, 0 to 180; 0: none")
        ->type_name("DEGREES")
        ->capture_default_str()
        ->group(group);
    app.add_option("--albedo", arguments.albedo,
                   "Albedo of surfaces without vertex colours: one value, or R,G,B, 0 to 1")
        ->capture_default_str()
        ->group(group);
    app.add_option("--surfaces", arguments.surfaces,
                   "glossy: the files' materials, which in glTF reflect like metal, varnish or "
                   "chalk; diffuse: their base colours alone, all chalk")
        ->check(CLI::IsMember({"glossy", "diffuse"}))
        ->capture_default_str()
        ->group(group);
    app.add_option("--material", arguments.material,
                   "Gloss of surfaces without material, as in roughness=0.3,metallic=0: roughness "
                   "[1] and metallic [0], 0 to 1; ior [1.5], at least 1; specular [1], 0 to 1")
        ->type_name("KEY=VALUE,...")
        ->group(group);
}

void defineCamera(CLI::App& app, Arguments& arguments) {
    RenderJob& job = arguments.job;
    const std::string group = "Camera";
    auto* camera = app.add_option("--camera", job.camera.name,
                                  "Camera file (JSON), or the name of a camera in a glTF set")
                       ->group(group);
    app.add_option("--frames", arguments.frames,
                   "Frames to render: A, A-B or A-BxSTEP, joined by commas [1]")
        ->group(group);
    app.add_option("--shot-frames", arguments.shotFrames,
                   "Frames that the maps of --env and the turn of --env-rotate are spread over, if "
                   "--frames are a part of them [those of --frames]")
        ->group(group);
    app.add_option("--fps", job.fps, "Frames per second of a glTF set's animations")
        ->capture_default_str()
        ->group(group);
    auto* eye = app.add_option("--eye", arguments.eye, "Position of the camera: X,Y,Z")
                    ->excludes(camera)
                    ->group(group);
    auto* target =
        app.add_option("--look-at", arguments.target, "Point that the camera looks at: X,Y,Z")
            ->needs(eye)
            ->group(group);
    eye->needs(target);
    app.add_option("--fov-y", job.camera.fovYDegrees,
                   "Vertical field of view in degrees, 0.01 to 179, with --eye")
        ->needs(eye)
        ->capture_default_str()
        ->group(group);
    app.add_option("--size", arguments.size, "Size of the picture in pixels: WxH")
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
    app.add_option("--triangles", options.paper.triangles,
                   "Triangles M of the map's triangulation, 20 to 100000")
        ->capture_default_str()
        ->group(paper);
    app.add_option("--alpha", options.paper.alpha, "Weight of the cached visibility, 0 to below 1")
        ->capture_default_str()
        ->group(paper);
    app.add_option("--threshold", options.paper.threshold,
                   "Minimum number of pooled rays for a region to be used")
        ->capture_default_str()
        ->group(paper);
    app.add_option("--max-level", options.paper.maxLevel, "Finest level of the triangles, 0 to 7")
        ->capture_default_str()
        ->group(paper);
    app.add_option("--order", options.paper.order,
                   "Importance within a triangle: 0 constant, 1 linear")
        ->capture_default_str()
        ->group(paper);
    app.add_option("--beta", options.paper.beta,
                   "Fraction of samples drawn uniformly over the hemisphere, 0 to 1")
        ->capture_default_str()
        ->group(paper);
    app.add_option("--convolution", arguments.convolution,
                   "table: interpolated between 32 x 64 normals; exact: computed at each normal")
        ->check(CLI::IsMember({"table", "exact"}))
        ->capture_default_str()
        ->group(paper);
    app.add_option("--cache-level", options.paper.cacheLevel,
                   "Finest direction level of the counts used, 0 to 7")
        ->capture_default_str()
        ->group(paper);
    const std::string others = "Estimators `lights` and `pixel`";
    app.add_option("--lights", options.lights.lights, "Directional lights K, 1 to 10000")
        ->capture_default_str()
        ->group(others);
    app.add_option("--pixel-map", arguments.pixelMap,
                   "Size of the low-resolution map: WxH, 8x4 to 4096x2048")
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
    app.add_option("--estimator", job.estimator, "Estimator of direct light:" + names)
        ->type_name("NAME:{" + choices + "}")
        ->group(group);
    auto* cache =
        app.add_option("--cache", job.cache, "Cache of the set, written by shadowcache-bake")
            ->group(group);
    app.add_option(
           "--memory", arguments.memory,
           "Memory limit for the cache, as in 4G or 512M: the file is read page by page as needed; "
           "the same picture, slower. Without it the whole file is loaded")
        ->type_name("SIZE")
        ->needs(cache)
        ->group(group);
    app.add_flag("--stale-ok", job.staleOk,
                 "Accept a cache baked for another set: unbiased, but noisier")
        ->group(group);
    auto* spp = app.add_option("--spp", arguments.spp,
                               "Shadow rays per pixel: as many camera rays with one each")
                    ->type_name("S")
                    ->group(group);
    auto* samples =
        app.add_option("--samples", job.render.samples,
                       "Shadow rays per camera ray; 0 with `cache`: a biased, noise-free preview")
            ->excludes(spp);
    samples->capture_default_str()->group(group);
    auto* rays = app.add_option("--camera-rays", job.render.cameraRays,
                                "Camera rays per pixel (antialiasing); `cache` sends up to 16 "
                                "times as many, with as many fewer samples each, where they are "
                                "predicted to differ")
                     ->excludes(spp);
    rays->capture_default_str()->group(group);
    app.add_option("--bounces", arguments.bounces,
                   "Surfaces that light may meet before the one that is seen: a number, or "
                   "unlimited; 0: direct light alone [4; 0 with biased estimators and "
                   "paper-image]")
        ->type_name("B")
        ->group(group);
    app.add_option("--clamp-indirect", job.render.clampIndirect,
                   "Cut the radiance that bounces add to a camera ray at this luminance: no "
                   "fireflies, but darker; 0: unbiased")
        ->type_name("L")
        ->capture_default_str()
        ->group(group);
    auto* preview =
        app.add_flag("--preview", job.render.preview,
                     "A few rays, and a filter: what they add to the prediction of the cache is "
                     "smoothed, its shadows are not. Biased, less so with more rays; "
                     "--camera-rays is 4 then and --samples 1, unless given. For a viewport: "
                     "--preview --camera-rays 1")
            ->needs(cache)
            ->group(group);
    app.add_option(
           "--target-error", arguments.targetError,
           "Choose the camera rays of each part of a frame so that the frame's relMSE comes "
           "to about this, from a pilot whose numbers the picture does not use; --samples is 4 "
           "then, unless given")
        ->excludes(spp)
        ->excludes(rays)
        ->excludes(preview)
        ->group(group);
    app.add_option(
           "--budget", arguments.budget,
           "uniform: --camera-rays for every pixel, --samples for every camera ray; adaptive: "
           "about --samples in the mean, allocated by the noise that `cache` predicts, and more "
           "camera rays where they differ")
        ->check(CLI::IsMember({"uniform", "adaptive"}))
        ->capture_default_str()
        ->group(group);
    app.add_option(
           "--pass-rays", job.render.passRays,
           "Camera rays of a pixel that are lit together, at most; --progressive writes the "
           "picture after each such pass")
        ->capture_default_str()
        ->group(group);
    app.add_option("--seed", job.render.seed, "Seed of all random numbers")
        ->check(notIn64Bits)
        ->capture_default_str()
        ->group(group);
    app.add_option("--sequence", arguments.sequence,
                   "Sample sequence: sobol (Owen-scrambled), random, larcher-xor or larcher-shift "
                   "(Larcher-Pillichshammer points, randomised)")
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
                   "EXR to write (.exr); #### or %04d becomes the frame number")
        ->group(group);
    auto* progressive = app.add_flag(
        "--progressive", job.progressive,
        "Render in passes of --pass-rays camera rays a pixel and write the EXR after each; Ctrl-C "
        "ends with the last pass that is complete, a second one at once");
    progressive->group(group);
    app.add_option("--time-limit", job.timeLimit,
                   "Seconds for the passes of a frame; the first is always completed. What "
                   "--target-error plans before them is not counted")
        ->needs(progressive)
        ->group(group);
    app.add_flag("--resume", job.resume,
                 "Skip frames that are complete and were rendered from the same settings and files")
        ->group(group);
    app.add_flag("--check", job.check,
                 "Render nothing: verify that every frame is complete and was rendered from the "
                 "same settings and files; the exit status is 1 if one is not")
        ->configurable(false)
        ->group(group);
    app.add_option("--aov", job.aovs, "Additional channels, any of:" + aovs)
        ->delimiter(',')
        ->take_all()
        ->check(CLI::IsMember(aovNames()))
        ->group(group);
    app.add_flag("--half", job.half, "16-bit channels instead of 32-bit")->group(group);
    app.add_flag(
           "--png", job.png,
           "Also write an sRGB PNG for each EXR, and one in false colour for the AOVs openness, "
           "expected_noise, items and misses")
        ->group(group);
    app.add_option("--exposure", job.exposure, "Exposure of the PNG in stops")
        ->capture_default_str()
        ->group(group);
    app.add_option(
           "--reference", job.reference,
           "EXR to compare with; reports the relative error on standard output and in --stats")
        ->group(group);
    app.add_option("--stats", job.stats, "Write times, rays and memory as JSON")->group(group);
    app.add_option("--debug", arguments.debug, "Print the samples of pixel X,Y; write no picture")
        ->excludes(app.get_option("--preview"))
        ->configurable(false)
        ->group(group);
    app.add_flag(
           "--explain", job.explain,
           "Print the estimator, its inputs, and the expected noise and time; write no picture")
        ->excludes(app.get_option("--target-error"))
        ->configurable(false)
        ->group(group);
    addThreadsOption(app, job.threads, group);
    addProgressOption(app, group);
}

/// CLI11 would require these with --list, too.
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
        "Renders a static set lit by an environment map, without bias, with fewer rays where a "
        "cache "
        "predicts the visibility and the light that bounces.",
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
    arguments.samplesGiven = app.get_option("--samples")->count() > 0;
    arguments.cameraRaysGiven = app.get_option("--camera-rays")->count() > 0;
    arguments.job.settings = settingsOf(app);
    return std::nullopt;
}

}  // namespace shadowcache
