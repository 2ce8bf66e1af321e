#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "common/version.h"
#include "render/film.h"
#include "render/job.h"

namespace shadowcache {
namespace {

/// What CLI11 fills before it becomes a RenderJob.
struct Arguments {
    std::string up = "y", frames, size = "960x540", sequence = "sobol";
    std::vector<double> eye, target;
    std::vector<float> albedo{0.5f};
    std::vector<int> debug;
};

void defineScene(CLI::App& app, RenderJob& job, Arguments& arguments) {
    const std::string group = "Scene";
    app.add_option("SET", job.files,
                   "Files of the set: OBJ, PLY, STL, OFF or OM; several make one set")
        ->required();
    app.add_option("--env", job.environment, "Lat-long map (EXR or HDR), or one radiance R,G,B")
        ->required()
        ->group(group);
    app.add_option("--env-rotate", job.environmentRotation,
                   "Degrees to turn the map about +Y, counter-clockwise from above")
        ->capture_default_str()
        ->group(group);
    app.add_option("--albedo", arguments.albedo,
                   "Albedo where the set has no vertex colours: one value, or R,G,B [0.5]")
        ->delimiter(',')
        ->expected(1, 3)
        ->group(group);
    app.add_option("--up", arguments.up, "Up axis of the files: y or z")
        ->check(CLI::IsMember({"y", "z"}))
        ->capture_default_str()
        ->group(group);
    app.add_option("--scale", job.mesh.scale, "Metres per unit of the files")
        ->capture_default_str()
        ->group(group);
}

void defineCamera(CLI::App& app, RenderJob& job, Arguments& arguments) {
    const std::string group = "Camera";
    auto* camera = app.add_option("--camera", job.cameraFile, "Camera move (JSON)")->group(group);
    app.add_option("--frames", arguments.frames,
                   "Frames of the move: A, A-B, A-BxSTEP, joined by commas [1]")
        ->needs(camera)
        ->group(group);
    auto* eye = app.add_option("--eye", arguments.eye, "Place of the camera: X,Y,Z")
                    ->delimiter(',')
                    ->expected(3)
                    ->excludes(camera)
                    ->group(group);
    auto* target = app.add_option("--look-at", arguments.target, "What it looks at: X,Y,Z")
                       ->delimiter(',')
                       ->expected(3)
                       ->needs(eye)
                       ->group(group);
    eye->needs(target);
    app.add_option("--fov-y", job.fovYDegrees, "Vertical angle of view in degrees, with --eye")
        ->check(CLI::Range(0.01, 179.0))
        ->capture_default_str()
        ->group(group);
    app.add_option("--size", arguments.size, "Picture in pixels: WxH")
        ->capture_default_str()
        ->group(group);
}

void defineEstimator(CLI::App& app, RenderJob& job, Arguments& arguments) {
    const std::string group = "Estimator";
    std::string names;
    for (const EstimatorEntry& entry : estimatorTable())
        names += std::string("\n  ") + entry.name + ": " + entry.summary;
    app.add_option("--estimator", job.estimator, "How the light is estimated:" + names)
        ->group(group);
    app.add_option("--cache", job.cache, "Cache of the set, from shadowcache-bake")->group(group);
    app.add_flag("--stale-ok", job.staleOk, "Use a cache of another set: unbiased all the same")
        ->group(group);
    app.add_option("--samples", job.render.samples,
                   "Shadow rays per camera ray; 0 with `cache`: a biased, noise-free preview")
        ->capture_default_str()
        ->group(group);
    app.add_option("--camera-rays", job.render.cameraRays, "Camera rays per pixel (antialiasing)")
        ->capture_default_str()
        ->group(group);
    app.add_option("--seed", job.render.seed, "Seed of all random numbers")
        ->capture_default_str()
        ->group(group);
    app.add_option("--sequence", arguments.sequence, "Numbers: sobol (Owen-scrambled) or random")
        ->check(CLI::IsMember({"sobol", "random"}))
        ->capture_default_str()
        ->group(group);
    const std::string paper = "Estimator `paper`";
    app.add_option("--triangles", job.estimatorOptions.triangles,
                   "M, triangles of the map, 20 to 100000")
        ->capture_default_str()
        ->group(paper);
    app.add_option("--alpha", job.estimatorOptions.alpha, "Trust in the cache, 0 to below 1")
        ->capture_default_str()
        ->group(paper);
    app.add_option("--threshold", job.estimatorOptions.threshold,
                   "Fewest pooled rays of a region that count")
        ->capture_default_str()
        ->group(paper);
    app.add_option("--max-level", job.estimatorOptions.maxLevel,
                   "Finest level of the triangles, to 7")
        ->capture_default_str()
        ->group(paper);
}

void defineOutput(CLI::App& app, RenderJob& job, Arguments& arguments) {
    const std::string group = "Output";
    std::string aovs;
    for (const std::string& name : aovNames()) aovs += " " + name;
    app.add_option("-o,--output", job.output, "EXR to write; #### becomes the frame's number")
        ->required()
        ->group(group);
    app.add_option("--aov", job.aovs, "More channels, any of:" + aovs)->group(group);
    app.add_flag("--half", job.half, "16-bit channels instead of 32-bit")->group(group);
    app.add_flag("--png", job.png, "An sRGB PNG beside each EXR")->group(group);
    app.add_option("--exposure", job.exposure, "Stops to brighten the PNG by")
        ->capture_default_str()
        ->group(group);
    app.add_option("--reference", job.reference,
                   "EXR to compare with; the relative error goes to standard output and --stats")
        ->group(group);
    app.add_option("--stats", job.stats, "Write what it took as JSON")->group(group);
    app.add_option("--debug", arguments.debug,
                   "Write nothing, but print how the pixel X,Y comes about")
        ->delimiter(',')
        ->expected(2)
        ->group(group);
    app.add_option("--threads", job.threads, "Threads; 0: one a core")
        ->capture_default_str()
        ->group(group);
}

/// Turns the arguments' texts into the job's values.
void complete(RenderJob& job, const Arguments& arguments) {
    if (job.cameraFile.empty() && arguments.eye.empty())
        throw CLI::RequiredError("--camera, or --eye with --look-at,");
    const auto vector = [](const std::vector<double>& v) { return Vec3d(v[0], v[1], v[2]); };
    if (!arguments.eye.empty()) {
        job.eye = vector(arguments.eye);
        job.lookAt = vector(arguments.target);
    }
    if (!arguments.frames.empty()) job.frames = parseFrames(arguments.frames);
    char rest = 0;
    if (std::sscanf(arguments.size.c_str(), "%dx%d%c", &job.render.width, &job.render.height,
                    &rest) != 2)
        throw CLI::ValidationError("--size", "'" + arguments.size + "': wanted WxH, as in 960x540");
    if (arguments.albedo.size() == 2)
        throw CLI::ValidationError("--albedo", "two values: wanted one, or R,G,B");
    for (std::size_t k = 0; k < 3; ++k)
        job.render.albedo[static_cast<int>(k)] =
            arguments.albedo[arguments.albedo.size() == 3 ? k : 0];
    if (!arguments.debug.empty()) job.debugPixel = {arguments.debug[0], arguments.debug[1]};
    job.mesh.zUp = arguments.up == "z";
    job.estimatorOptions.sequence =
        arguments.sequence == "random" ? Sequence::random : Sequence::sobol;
    job.estimatorOptions.minLevel =
        std::min(job.estimatorOptions.minLevel, job.estimatorOptions.maxLevel);
}

/// Every option's name and value, for the pictures' metadata.
void recordSettings(const CLI::App& app, RenderJob& job) {
    for (const CLI::Option* option : app.get_options()) {
        const std::string name = option->get_single_name();
        if (name == "help" || name == "version") continue;
        std::string value = option->get_default_str();
        if (option->count() > 0) {
            value.clear();
            for (const std::string& part : option->results())
                value += (value.empty() ? "" : " ") + part;
        }
        if (!value.empty()) job.settings.emplace_back(name, value);
    }
}

}  // namespace
}  // namespace shadowcache

int main(int argc, char** argv) try {
    using namespace shadowcache;
    CLI::App app(
        "Renders a static set under an HDRI: unbiased direct light, with few shadow rays where a "
        "cache tells "
        "where they matter.",
        "shadowcache-render");
    RenderJob job;
    Arguments arguments;
    app.set_version_flag("--version", std::string("shadowcache-render ") + kVersion);
    defineScene(app, job, arguments);
    defineCamera(app, job, arguments);
    defineEstimator(app, job, arguments);
    defineOutput(app, job, arguments);
    app.footer(
        "Examples:\n"
        "  shadowcache-render room.obj --env sky.exr --cache room.vdb --eye 1,1.6,3 --look-at "
        "0,1,0 -o still.exr --png\n"
        "  shadowcache-render set.ply --env sun.hdr --cache set.vdb --camera move.json --frames "
        "1-24 -o shot.####.exr\n"
        "  shadowcache-render set.ply --env 1,1,1 --eye 1,1,1 --look-at 0,0,0 --estimator mis "
        "--samples 256 -o a.exr");
    try {
        app.parse(argc, argv);
        complete(job, arguments);
    } catch (const CLI::ParseError& e) {
        return app.exit(e);
    }
    recordSettings(app, job);
    run(job);
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "shadowcache-render: %s\n", e.what());
    return 1;
}
