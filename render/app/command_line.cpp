#include "render/app/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "common/cli/command_line.h"
#include "common/cli/options.h"
#include "render/frame/aov_channels.h"
#include "render/frame/film.h"

namespace shadowcache {

namespace {

using std::string_view_literals::operator""sv;

constexpr Named<bool> kNormals[] = {{"shading", true}, {"geometric", false}};
constexpr Named<bool> kSurfaces[] = {{"glossy", true}, {"diffuse", false}};
constexpr Named<bool> kBudgets[] = {{"uniform", false}, {"adaptive", true}};

// Groups of what a shot needs, which --help shows, and of all else.
constexpr const char* kSet = "Set and light";
constexpr const char* kCamera = "Camera";
constexpr const char* kQuality = "Quality";
constexpr const char* kOutput = "Output";
constexpr const char* kSurface = "Surfaces";
constexpr const char* kPicture = "Pictures";
constexpr const char* kSampling = "Sampling";
constexpr const char* kRun = "Runs and reports";

void defineSet(CLI::App& app, Arguments& arguments) {
    RenderJob& job = arguments.job;
    addSetOptions(app, arguments.shot, kSet, kSurface);
    app.add_option(
           "--env", job.light.environment,
           "Lat-long map (EXR or HDR), or a constant radiance R,G,B; for one map per frame: maps "
           "joined by commas, or a sequence with ####")
        ->group(kSet);
    app.add_option("--env-rotate", job.light.rotation,
                   "Rotation of the map about +Y in degrees, counter-clockwise seen from above; "
                   "A-B: from A in the first frame to B in the last; X,Y,Z: about +X, then +Y, "
                   "then +Z; or the nine numbers of an orthogonal matrix, row by row, that takes "
                   "directions of the map to those of the world, reflections included")
        ->capture_default_str()
        ->group(kSet);
    app.add_option("--env-gain", job.light.gain,
                   "What the radiance of the map is multiplied by, a factor or R,G,B; 0 to 1e6")
        ->capture_default_str()
        ->group(kSet);
}

void defineCamera(CLI::App& app, Arguments& arguments) {
    RenderJob& job = arguments.job;
    addShotOptions(app, arguments.shot, kCamera, kPicture);
    auto* eye = app.add_option("--eye", arguments.eye, "Position of the camera: X,Y,Z")
                    ->excludes("--camera")
                    ->group(kCamera);
    auto* target =
        app.add_option("--look-at", arguments.target, "Point that the camera looks at: X,Y,Z")
            ->needs(eye)
            ->group(kCamera);
    eye->needs(target);
    app.add_option("--fov-y", job.camera.fovYDegrees,
                   "Vertical field of view in degrees, 0.01 to 179, with --eye")
        ->needs(eye)
        ->capture_default_str()
        ->group(kCamera);
}

void defineQuality(CLI::App& app, Arguments& arguments) {
    RenderJob& job = arguments.job;
    app.add_option("--cache", job.cache, "Cache of the set, written by shadowcache-bake")
        ->group(kQuality);
    app.add_option("--spp", arguments.spp, "Shadow rays a pixel: as many camera rays with one each")
        ->type_name("S")
        ->default_str("64")
        ->group(kQuality);
    app.add_option("--bounces", arguments.bounces,
                   "Surfaces that light may meet before the one that is seen: a number, or "
                   "unlimited; 0: direct light alone [4]")
        ->type_name("B")
        ->group(kQuality);
    app.add_flag("--preview", arguments.preview,
                 "Show what the cache predicts, and of --spp [4] shadow rays a pixel what they "
                 "add, filtered. Biased, less so with more rays; with --spp 0 no ray is traced "
                 "but the camera's. For a viewport: --preview --spp 1")
        ->needs("--cache")
        ->group(kQuality);
    app.add_option(
           "--target-error", arguments.targetError,
           "Choose the camera rays of each part of a frame so that the frame's relMSE comes "
           "to about this, from a pilot whose numbers the picture does not use; --samples is 4 "
           "then, unless given")
        ->excludes("--spp")
        ->excludes("--preview")
        ->group(kQuality);
    app.add_option(
           "--memory", arguments.memory,
           "Memory limit for the cache, as in 4G or 512M: the file is read page by page as needed; "
           "the same picture, slower. Without it the whole file is loaded")
        ->type_name("SIZE")
        ->needs("--cache")
        ->group(kQuality);
}

void defineOutput(CLI::App& app, Arguments& arguments) {
    RenderJob& job = arguments.job;
    app.add_option("-o,--output", job.output,
                   "EXR to write (.exr); #### or %04d becomes the frame number")
        ->group(kOutput);
    addListOption(app, "--aov", job.aovs, aovNames(), "Additional channels, joined by commas")
        ->group(kOutput);
    app.add_flag("--transparent", job.render.transparent,
                 "Leave the sky out of the picture and write what the set covers as alpha (A); "
                 "colours are multiplied by it")
        ->group(kPicture);
    app.add_flag(
           "--png", job.png,
           "Also write an sRGB PNG for each EXR, and one in false colour for the AOVs openness, "
           "expected_noise, items and misses")
        ->group(kOutput);
    app.add_option("--exposure", job.exposure, "Exposure of the PNG in stops")
        ->capture_default_str()
        ->group(kOutput);
    app.add_flag("--resume", job.resume,
                 "Skip frames that are complete and were rendered from the same settings and files")
        ->group(kOutput);
    addThreadsOption(app, job.threads, kOutput);
}

void defineSurfaces(CLI::App& app, Arguments& arguments) {
    RenderJob& job = arguments.job;
    addChoice(app, "--normals", job.mesh.shadingNormals, kNormals,
              "shading: the files' normals, where they have some; geometric: each "
              "triangle's own")
        ->group(kSurface);
    app.add_option("--smooth", job.mesh.smoothDegrees,
                   "Smooth triangles without shading normals where neighbours differ by at most "
                   "DEGREES, 0 to 180; 0: none")
        ->type_name("DEGREES")
        ->capture_default_str()
        ->group(kSurface);
    app.add_option("--albedo", arguments.albedo,
                   "Albedo of surfaces without vertex colours: one value, or R,G,B, 0 to 1")
        ->capture_default_str()
        ->group(kSurface);
    addChoice(app, "--surfaces", job.mesh.gloss, kSurfaces,
              "glossy: the files' materials, which in glTF reflect like metal, varnish or "
              "chalk; diffuse: their base colours alone, all chalk")
        ->group(kSurface);
    app.add_option("--material", arguments.material,
                   "Gloss of surfaces without material, as in roughness=0.3,metallic=0: roughness "
                   "[1] and metallic [0], 0 to 1; ior [1.5], at least 1; specular [1], 0 to 1")
        ->type_name("KEY=VALUE,...")
        ->group(kSurface);
}

void definePicture(CLI::App& app, Arguments& arguments) {
    RenderJob& job = arguments.job;
    app.add_option("--crop", arguments.crop,
                   "Render only this part of the picture: X,Y,WxH from the upper left pixel X,Y; "
                   "the same pixels as in the whole picture")
        ->group(kPicture);
    addChoice(app, "--filter", job.render.filter, kFilters,
              "Pixel filter of several camera rays: box, gaussian or blackman-harris")
        ->group(kPicture);
    app.add_option("--filter-width", job.render.filterWidth,
                   "Its width in pixels as in Blender; 0: 1 for the box, 1.5 for the others")
        ->capture_default_str()
        ->group(kPicture);
    app.add_option("--shot-frames", arguments.shotFrames,
                   "Frames that the maps of --env and the turn of --env-rotate are spread over, if "
                   "--frames are a part of them [those of --frames]")
        ->group(kPicture);
    app.add_flag("--half", job.half, "16-bit channels instead of 32-bit")->group(kPicture);
}

void defineSampling(CLI::App& app, Arguments& arguments) {
    RenderJob& job = arguments.job;
    std::string names, choices;
    for (const EstimatorEntry& entry : estimatorTable()) {
        names += std::string("\n  ") + entry.name + ": " + entry.summary;
        choices += (choices.empty() ? "" : ",") + std::string(entry.name);
    }
    app.add_option("--estimator", job.estimator,
                   "Estimator of direct light [cache with --cache, mis without]:" + names)
        ->type_name("NAME:{" + choices + "}")
        ->group(kSampling);
    app.add_flag("--stale-ok", job.staleOk,
                 "Accept a cache baked for another set: unbiased, but noisier")
        ->group(kSampling);
    app.add_option("--camera-rays", arguments.cameraRays,
                   "Camera rays per pixel (antialiasing), in place of --spp; `cache` sends up to "
                   "16 times as many, with as many fewer samples each, where they are predicted "
                   "to differ [1 with --samples]")
        ->excludes("--spp")
        ->excludes("--target-error")
        ->group(kSampling);
    app.add_option("--samples", arguments.samples,
                   "Shadow rays per camera ray, in place of --spp [1 with --camera-rays]; 0 with "
                   "`cache`: what --preview --spp 0 shows")
        ->excludes("--spp")
        ->group(kSampling);
    addChoice(app, "--budget", job.estimatorOptions.cache.adaptive, kBudgets,
              "uniform: --camera-rays for every pixel, --samples for every camera ray; adaptive: "
              "about --samples in the mean, allocated by the noise that `cache` predicts, and more "
              "camera rays where they differ")
        ->group(kSampling);
    app.add_option("--clamp-indirect", job.render.clampIndirect,
                   "Cut the radiance that bounces add to a camera ray at this luminance: no "
                   "fireflies, but darker; 0: unbiased")
        ->type_name("L")
        ->capture_default_str()
        ->group(kSampling);
    app.add_option(
           "--pass-rays", job.render.passRays,
           "Camera rays of a pixel that are lit together, at most; --progressive writes the "
           "picture after each such pass")
        ->capture_default_str()
        ->group(kSampling);
    addSeedOption(app, job.render.seed, "Seed of all random numbers")->group(kSampling);
    addChoice(app, "--sequence", job.sequence, kSequences,
              "Sample sequence: sobol (Owen-scrambled) or random")
        ->group(kSampling);
}

void defineRun(CLI::App& app, Arguments& arguments) {
    RenderJob& job = arguments.job;
    app.add_flag("--list", arguments.list,
                 "Print cameras, animations and sizes of a glTF set, and exit")
        ->group(kRun);
    app.add_flag("--serve", arguments.serve,
                 "Stay, and render what requests on standard input ask for, as docs/serve.md has "
                 "them; beside it only --threads counts")
        ->configurable(false)
        ->group(kRun);
    app.add_flag(
           "--explain", job.explain,
           "Print the estimator, its inputs, and the expected noise and time; write no picture")
        ->excludes("--target-error")
        ->configurable(false)
        ->group(kRun);
    app.add_flag("--check", job.check,
                 "Render nothing: verify that every frame is complete and was rendered from the "
                 "same settings and files; the exit status is 1 if one is not")
        ->configurable(false)
        ->group(kRun);
    auto* progressive = app.add_flag(
        "--progressive", job.progressive,
        "Render in passes of --pass-rays camera rays a pixel and write the EXR after each; Ctrl-C "
        "ends with the last pass that is complete, a second one at once");
    progressive->group(kRun);
    app.add_option("--time-limit", job.timeLimit,
                   "Seconds for the passes of a frame; the first is always completed. What "
                   "--target-error plans before them is not counted")
        ->needs(progressive)
        ->group(kRun);
    app.add_option(
           "--reference", job.reference,
           "EXR to compare with; reports the relative error on standard output and in --stats")
        ->group(kRun);
    app.add_option("--stats", job.stats, "Write times, rays and memory as JSON")->group(kRun);
    app.add_option("--debug", arguments.debug, "Print the samples of pixel X,Y; write no picture")
        ->excludes("--preview")
        ->configurable(false)
        ->group(kRun);
    addProgressOption(app, kRun);
}

/// CLI11 would require these with --list and --serve, too.
void requireWhatRendersNeed(const Arguments& arguments) {
    const RenderJob& job = arguments.job;
    if (job.light.environment.empty()) throw CLI::RequiredError("--env");
    if (job.output.empty()) throw CLI::RequiredError("--output");
    if (arguments.shot.camera.empty() && arguments.eye.empty())
        throw CLI::RequiredError("--camera, or --eye with --look-at,");
}

/// Requests say all that a run takes.
void requireNothingElse(const CLI::App& app) {
    for (const CLI::Option* option : app.get_options())
        if (option->count() > 0 && !option->check_lname("serve") && !option->check_lname("threads"))
            throw CLI::ExcludesError("--serve", option->get_name());
}

constexpr const char* kExamples =
    "Examples:\n"
    "  shadowcache-render room.obj --env sky.exr --cache room.vdb --eye 1,1.6,3 --look-at "
    "0,1,0 -o still.exr --png\n"
    "  shadowcache-render set.ply --env sun.hdr --cache set.vdb --camera move.json --frames "
    "1-24 -o shot.####.exr\n"
    "  shadowcache-render set.glb --env sky.####.exr --cache set.vdb --camera shot --frames "
    "1-240 --resume -o shot.####.exr\n"
    "  shadowcache-render set.ply --env 1,1,1 --eye 1,1,1 --look-at 0,0,0 --spp 256 "
    "-o a.exr\n"
    "  shadowcache-render --config shot.toml --explain";

}  // namespace

std::optional<int> parseArguments(int argc, char** argv, Arguments& arguments) {
    CLI::App app(
        "Renders a static set lit by an environment map, without bias, with fewer rays where a "
        "cache "
        "predicts the visibility and the light that bounces.",
        "shadowcache-render");
    beginCommandLine(app);
    showInHelp(app, {"Options", kSet, kCamera, kQuality, kOutput, "Settings file"});
    defineSet(app, arguments);
    defineCamera(app, arguments);
    defineQuality(app, arguments);
    defineOutput(app, arguments);
    defineSurfaces(app, arguments);
    definePicture(app, arguments);
    defineSampling(app, arguments);
    defineRun(app, arguments);
    app.footer(kExamples);
    // Its requests name the set.
    if (std::any_of(argv, argv + argc, [](const char* word) { return "--serve"sv == word; }))
        app.get_option("SET")->required(false);
    const auto check = [&] {
        if (arguments.serve) return requireNothingElse(app);
        if (!arguments.list) requireWhatRendersNeed(arguments);
    };
    if (const auto status = parseCommandLine(app, argc, argv, check)) return status;
    arguments.job.settings = settingsOf(app);
    return std::nullopt;
}

}  // namespace shadowcache
