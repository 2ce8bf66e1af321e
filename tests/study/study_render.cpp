// Renders a picture with one of the techniques that the paper compares: shadowcache-render with the
// estimators, options and sequences that only the study needs. Direct light, one camera ray a
// pixel.

#include <array>
#include <cstdio>
#include <exception>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "common/base/exit_status.h"
#include "common/base/json_file.h"
#include "common/base/option_checks.h"
#include "common/base/option_text.h"
#include "common/base/parallel.h"
#include "common/base/report_failure.h"
#include "common/cache/shadow_cache.h"
#include "common/cli/command_line.h"
#include "common/image/exr.h"
#include "common/image/png.h"
#include "common/import/load_mesh.h"
#include "common/shot/camera_source.h"
#include "common/trace/scene.h"
#include "render/frame/aov_channels.h"
#include "render/frame/compare.h"
#include "render/frame/integrator.h"
#include "render/frame/pilot.h"
#include "render/library/option_table.h"
#include "render/shot/environment_loader.h"
#include "tests/study/estimators/larcher_sequence.h"
#include "tests/study/estimators/technique_table.h"

namespace shadowcache::study {
namespace {

constexpr Named<bool> kBudgets[] = {{"uniform", false}, {"adaptive", true}};
constexpr Named<bool> kConvolutions[] = {{"table", false}, {"exact", true}};

/// How the numbers of a pixel's samples are made.
constexpr Named<Sequence (*)(std::uint32_t samples)> kSequencesOfStudy[] = {
    {"sobol", [](std::uint32_t) { return Sequence::kSobol; }},
    {"random", [](std::uint32_t) { return Sequence::kRandom; }},
    {"larcher-xor", larcherXor},
    {"larcher-shift", larcherShift}};

/// The command line.
struct Arguments {
    RenderJob job;
    std::string technique = "paper";
    TechniqueOptions options;
    Sequence (*sequence)(std::uint32_t) = kSequencesOfStudy[0].value;
};

/// Options of shadowcache-render that are options here.
const std::set<std::string>& sharedOptions() {
    static const std::set<std::string> names{
        "SET",        "up",      "scale", "set-frame", "allow-external", "env",
        "env-rotate", "camera",  "eye",   "look-at",   "fov-y",          "frames",
        "fps",        "shutter", "size",  "albedo",    "samples",        "seed",
        "cache",      "output",  "png",   "exposure",  "reference",      "stats"};
    return names;
}

/// Those that only the study has.
std::vector<OptionRow> techniqueRows(Arguments& a) {
    std::string names;
    for (const Technique& technique : techniques())
        names += "\n  " + technique.name + ": " + technique.summary +
                 (technique.bias == "none" ? "" : " (biased)");
    VariantOptions& paper = a.options.paper;
    constexpr int kMost = std::numeric_limits<int>::max();
    const auto readMap = [&a](const std::string& text) {
        const auto [columns, lines] = pairOf("pixel-map", text, "WxH, as in 200x100");
        a.options.pixel = {columns, lines};
    };
    // What is out of range is refused by validate().
    return {
        textRow("estimator", a.technique, "Technique:" + names),
        wordRow("sequence", a.sequence, kSequencesOfStudy,
                "Sample sequence: sobol (Owen-scrambled), random, larcher-xor or larcher-shift "
                "(Larcher-Pillichshammer points, randomised)"),
        wordRow("budget", a.options.cache.adaptive, kBudgets,
                "uniform: --samples for every pixel; adaptive: in the mean, allocated by the "
                "noise that `cache` predicts"),
        wholeRow("triangles", paper.triangles, 0, kMost,
                 "Triangles M of the map's triangulation, 20 to 100000"),
        numberRow("alpha", paper.alpha, {}, "Weight of the cached visibility, 0 to below 1"),
        wholeRow("threshold", paper.threshold, 0, kMost,
                 "Minimum number of pooled rays for a region to be used"),
        wholeRow("max-level", paper.maxLevel, 0, kMost, "Finest level of the triangles, 0 to 7"),
        wholeRow("order", paper.order, 0, 1, "Importance within a triangle: 0 constant, 1 linear"),
        numberRow("beta", paper.beta, {0, 1},
                  "Fraction of samples drawn uniformly over the hemisphere, 0 to 1"),
        wordRow("convolution", paper.exactConvolution, kConvolutions,
                "table: interpolated between 32 x 64 normals; exact: computed at each normal"),
        wholeRow("cache-level", paper.cacheLevel, 0, kMost,
                 "Finest direction level of the counts used, 0 to 7"),
        wholeRow("lights", a.options.lights.lights, 0, kMost, "Directional lights K, 1 to 10000"),
        ownRow("pixel-map", OptionForm::text, readMap,
               "Size of the low-resolution map: WxH, 8x4 to 4096x2048 [200x100]")};
}

std::vector<OptionRow> rowsOf(Arguments& a) {
    std::vector<OptionRow> rows;
    for (OptionRow& row : optionRows(a.job)) {
        if (!sharedOptions().contains(row.name)) continue;
        row.isRequired = row.name == "SET" || row.name == "env" || row.name == "output";
        rows.push_back(std::move(row));
    }
    for (OptionRow& row : techniqueRows(a)) {
        row.group = "Technique";
        rows.push_back(std::move(row));
    }
    return rows;
}

/// Refuses what is out of range.
Technique complete(Arguments& a) {
    RenderOptions& options = a.job.picture.options;
    options.samples = a.job.picture.rays.samples.value_or(options.samples);
    a.options.paper.minLevel = std::min(a.options.paper.minLevel, a.options.paper.maxLevel);
    validate(a.options);
    shadowcache::validate(options);
    requireRange("samples", options.samples, 1, kMostSamples);
    requireExtension(a.job.run.output, ".exr");
    Technique technique = findTechnique(a.technique);
    if (technique.needsCache && a.job.stage.cache.empty())
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
    out.write(a.job.run.stats);
}

void run(Arguments a) {
    const Technique technique = complete(a);
    if (technique.inOrder) setThreadCount(1);
    const SetOptions& set = a.job.stage.set;
    const RunOptions& outputs = a.job.run;
    const RenderOptions& options = a.job.picture.options;
    const TriangleMesh mesh = loadMesh(set.files, meshOptionsOf(set));
    const int number = outputs.frames.front();
    const CameraSource camera(a.job.camera, {});
    const LightPlan lights(a.job.light, std::array{number});
    EnvironmentLoader light([](const std::string&, NoteKind) {});
    light.load(lights.at(0));
    std::optional<ShadowCache> cache;
    if (!a.job.stage.cache.empty()) cache.emplace(a.job.stage.cache);
    const Scene scene(mesh);
    const auto samples = static_cast<std::uint32_t>(options.samples);
    const auto estimator = makeEstimator(
        technique.name,
        {scene, light.environment(), cache ? &*cache : nullptr, a.sequence(samples)}, a.options);
    FrameRequest frame{*estimator, camera.moveAt(number), number, options};
    RenderStats stats;
    frame.plan = planFrame(frame, stats);
    const Film film = render(frame, stats);
    writeExr(outputs.output, film.width, film.height, channels(film, {}),
             {{"shadowcache:bias", technique.bias}}, PixelType::full,
             {film.x, film.y, film.frameWidth, film.frameHeight});
    const Image image = colorImage(film);
    if (outputs.png) {
        auto png = outputs.output;
        writePng(png.replace_extension(".png"), image, outputs.exposure);
    }
    std::optional<RelativeError> error;
    if (!outputs.reference.empty())
        error = relativeError(image, readReference(outputs.reference, options));
    if (!outputs.stats.empty()) writeStats(a, technique, stats, error);
}

}  // namespace
}  // namespace shadowcache::study

int main(int argc, char** argv) try {
    using namespace shadowcache;
    installFailureHandler();
    study::Arguments arguments;
    const ParsedLine parsed = parseCommandLine(
        {"shadowcache-study-render", "Renders with the techniques that the paper compares.", ""},
        argc, argv, study::rowsOf(arguments));
    if (parsed.status) return *parsed.status;
    study::run(arguments);
    return kDone;
} catch (const std::exception& e) {
    return shadowcache::reportFailure("shadowcache-study-render", e);
}
