// Renders a picture with one of the techniques that the paper compares: shadowcache-render with the
// estimators, options and sequences that only the study needs. Direct light, one camera ray a
// pixel.

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "common/base/exit_status.h"
#include "common/base/json_file.h"
#include "common/base/option_checks.h"
#include "common/base/parallel.h"
#include "common/base/report_failure.h"
#include "common/cache/shadow_cache.h"
#include "common/cli/command_line.h"
#include "common/cli/options.h"
#include "common/command/shot_arguments.h"
#include "common/image/exr.h"
#include "common/image/png.h"
#include "common/import/load_mesh.h"
#include "common/shot/camera_source.h"
#include "common/shot/frames.h"
#include "common/trace/scene.h"
#include "render/frame/aov_channels.h"
#include "render/frame/compare.h"
#include "render/frame/integrator.h"
#include "render/frame/pilot.h"
#include "render/shot/environment_loader.h"
#include "tests/study/estimators/larcher_sequence.h"
#include "tests/study/estimators/technique_table.h"

namespace shadowcache::study {
namespace {

constexpr Named<bool> kBudgets[] = {{"uniform", false}, {"adaptive", true}};
constexpr Named<bool> kConvolutions[] = {{"table", false}, {"exact", true}};

/// How the numbers of a pixel's samples are made.
constexpr Named<Sequence (*)(std::uint32_t samples)> kSequencesOfStudy[] = {
    {"sobol", [](std::uint32_t) { return Sequence::sobol; }},
    {"random", [](std::uint32_t) { return Sequence::random; }},
    {"larcher-xor", larcherXor},
    {"larcher-shift", larcherShift}};

/// The command line.
struct Arguments {
    ShotArguments shot;
    std::vector<double> eye, lookAt;
    CameraOptions camera;
    LightOptions light;
    std::string technique = "paper", pixelMap = "200x100";
    TechniqueOptions options;
    Sequence (*sequence)(std::uint32_t) = kSequencesOfStudy[0].value;
    std::filesystem::path cache, output, reference, stats;
    RenderOptions render;
    float albedo = 0.5f, exposure = 0;
    bool png = false;
};

void definePicture(CLI::App& app, Arguments& a) {
    addSetOptions(app, a.shot, "Picture", "Picture");
    addShotOptions(app, a.shot, "Picture", "Picture");
    app.add_option("--env", a.light.environment, "Lat-long map, or a constant radiance R,G,B")
        ->required();
    app.add_option("--env-rotate", a.light.rotation, "Rotation of the map about +Y in degrees");
    app.add_option("--eye", a.eye, "Position of the camera: X,Y,Z")->delimiter(',')->expected(3);
    app.add_option("--look-at", a.lookAt, "Point that it looks at: X,Y,Z")
        ->delimiter(',')
        ->expected(3);
    app.add_option("--fov-y", a.camera.fovYDegrees, "Vertical field of view in degrees");
    app.add_option("--albedo", a.albedo, "Albedo of surfaces without colours, 0 to 1");
    app.add_option("--samples", a.render.samples, "Samples a pixel")->capture_default_str();
    addSeedOption(app, a.render.seed, "Seed of all random numbers");
    app.add_option("--cache", a.cache, "Cache of the set, written by shadowcache-bake");
    app.add_option("-o,--output", a.output, "EXR to write")->required();
    app.add_flag("--png", a.png, "Also write an sRGB PNG");
    app.add_option("--exposure", a.exposure, "Exposure of the PNG in stops");
    app.add_option("--reference", a.reference, "EXR to compare with");
    app.add_option("--stats", a.stats, "Write rays and errors as JSON");
}

void defineTechnique(CLI::App& app, Arguments& a) {
    std::string names;
    for (const Technique& technique : techniques())
        names += "\n  " + technique.name + ": " + technique.summary +
                 (technique.bias == "none" ? "" : " (biased)");
    app.add_option("--estimator", a.technique, "Technique:" + names)->capture_default_str();
    addChoice(app, "--sequence", a.sequence, kSequencesOfStudy,
              "Sample sequence: sobol (Owen-scrambled), random, larcher-xor or larcher-shift "
              "(Larcher-Pillichshammer points, randomised)");
    addChoice(app, "--budget", a.options.cache.adaptive, kBudgets,
              "uniform: --samples for every pixel; adaptive: in the mean, allocated by the noise "
              "that `cache` predicts");
    VariantOptions& paper = a.options.paper;
    app.add_option("--triangles", paper.triangles,
                   "Triangles M of the map's triangulation, 20 to 100000");
    app.add_option("--alpha", paper.alpha, "Weight of the cached visibility, 0 to below 1");
    app.add_option("--threshold", paper.threshold,
                   "Minimum number of pooled rays for a region to be used");
    app.add_option("--max-level", paper.maxLevel, "Finest level of the triangles, 0 to 7");
    app.add_option("--order", paper.order, "Importance within a triangle: 0 constant, 1 linear");
    app.add_option("--beta", paper.beta,
                   "Fraction of samples drawn uniformly over the hemisphere, 0 to 1");
    addChoice(app, "--convolution", paper.exactConvolution, kConvolutions,
              "table: interpolated between 32 x 64 normals; exact: computed at each normal");
    app.add_option("--cache-level", paper.cacheLevel,
                   "Finest direction level of the counts used, 0 to 7");
    app.add_option("--lights", a.options.lights.lights, "Directional lights K, 1 to 10000");
    app.add_option("--pixel-map", a.pixelMap,
                   "Size of the low-resolution map: WxH, 8x4 to 4096x2048");
}

/// Reads the options that are texts, and refuses what is out of range.
Technique complete(Arguments& a) {
    const auto [width, height] = sizeOf(a.shot);
    a.render.width = width;
    a.render.height = height;
    a.render.plain.albedo = Rgb(a.albedo);
    a.camera.name = a.shot.camera;
    if (!a.eye.empty() && !a.lookAt.empty()) {
        a.camera.eye = Vec3d(a.eye[0], a.eye[1], a.eye[2]);
        a.camera.lookAt = Vec3d(a.lookAt[0], a.lookAt[1], a.lookAt[2]);
    }
    const auto [columns, rows] = parsePair("--pixel-map", a.pixelMap, "WxH, as in 200x100");
    a.options.pixel = {columns, rows};
    a.options.paper.minLevel = std::min(a.options.paper.minLevel, a.options.paper.maxLevel);
    validate(a.options);
    shadowcache::validate(a.render);
    requireRange("samples", a.render.samples, 1, kMostSamples);
    requireExtension(a.output, ".exr");
    Technique technique = findTechnique(a.technique);
    if (technique.needsCache && a.cache.empty())
        throw Error("--estimator " + a.technique + " requires --cache");
    return technique;
}

void writeStats(const Arguments& a, const Technique& technique, const RenderStats& stats,
                const std::optional<RelativeError>& error) {
    JsonFile out;
    out.set("estimator", technique.name);
    out.set("bias", technique.bias);
    out.set("rays.shadow", stats.shadowRays);
    if (error) {
        out.set("error.relmse", error->mean);
        out.set("error.l2", error->l2);
        out.set("error.p99", error->p99);
    }
    out.write(a.stats);
}

void run(Arguments a) {
    const Technique technique = complete(a);
    if (technique.inOrder) setThreadCount(1);
    const MeshOptions meshOptions = meshOptionsOf(a.shot, {.shadingNormals = true, .gloss = true});
    const TriangleMesh mesh = loadMesh(a.shot.files, meshOptions);
    const int number = a.shot.frames.empty() ? 1 : parseFrames(a.shot.frames).front();
    const CameraSource camera(a.camera, {});
    const LightPlan lights(a.light, std::array{number});
    EnvironmentLoader light([](const std::string&, NoteKind) {});
    light.load(lights.at(0));
    std::optional<ShadowCache> cache;
    if (!a.cache.empty()) cache.emplace(a.cache);
    const Scene scene(mesh);
    const auto samples = static_cast<std::uint32_t>(a.render.samples);
    const auto estimator = makeEstimator(
        technique.name,
        {scene, light.environment(), cache ? &*cache : nullptr, a.sequence(samples)}, a.options);
    FrameRequest frame{*estimator, camera.moveAt(number), number, a.render};
    RenderStats stats;
    frame.plan = planFrame(frame, stats);
    const Film film = render(frame, stats);
    writeExr(a.output, film.width, film.height, channels(film, {}),
             {{"shadowcache:bias", technique.bias}}, PixelType::full,
             {film.x, film.y, film.frameWidth, film.frameHeight});
    const Image image = colorImage(film);
    if (a.png) {
        auto png = a.output;
        writePng(png.replace_extension(".png"), image, a.exposure);
    }
    std::optional<RelativeError> error;
    if (!a.reference.empty()) error = relativeError(image, readReference(a.reference, a.render));
    if (!a.stats.empty()) writeStats(a, technique, stats, error);
}

}  // namespace
}  // namespace shadowcache::study

int main(int argc, char** argv) try {
    using namespace shadowcache;
    installFailureHandler();
    study::Arguments arguments;
    CLI::App app("Renders with the techniques that the paper compares.",
                 "shadowcache-study-render");
    beginCommandLine(app);
    study::definePicture(app, arguments);
    study::defineTechnique(app, arguments);
    if (const auto status = parseCommandLine(app, argc, argv)) return *status;
    study::run(arguments);
    return kDone;
} catch (const std::exception& e) {
    return shadowcache::reportFailure("shadowcache-study-render", e);
}
