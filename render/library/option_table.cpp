#include "render/library/option_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <string_view>
#include <utility>

#include "common/base/option_checks.h"
#include "common/base/option_text.h"
#include "common/base/run_rows.h"
#include "common/base/take_text.h"
#include "common/shot/frames.h"
#include "render/frame/aov_channels.h"

namespace shadowcache {

namespace {

using Rows = std::vector<OptionRow>;
using enum Door;

constexpr Named<bool> kNormals[] = {{"shading", true}, {"geometric", false}};
constexpr Named<bool> kSurfaces[] = {{"glossy", true}, {"diffuse", false}};
constexpr Named<bool> kLamps[] = {{"on", true}, {"off", false}};
constexpr Named<bool> kBudgets[] = {{"uniform", false}, {"adaptive", true}};

constexpr double kMostBakeSpacing = 1e12;  // [m]
constexpr const char* kBakeQualities[] = {"draft", "good", "fine"};

constexpr const char* kSet = kShortHelp[0];
constexpr const char* kCamera = kShortHelp[1];
constexpr const char* kQuality = kShortHelp[2];
constexpr const char* kOutput = kShortHelp[3];
constexpr const char* kSurface = "Surfaces";
constexpr const char* kPicture = "Pictures";
constexpr const char* kSampling = "Sampling";
constexpr const char* kRun = "Runs and reports";

void add(Rows& rows, const char* group, std::initializer_list<OptionRow> more) {
    for (const OptionRow& row : more) rows.emplace_back(row).group = group;
}

OptionRow ofNumbers(OptionRow row, std::vector<std::size_t> counts, std::string standard = "") {
    row.counts = std::move(counts);
    row.standard = std::move(standard);
    return row;
}

/// X,Y,Z.
OptionRow placeRow(const std::string& name, std::optional<Vec3d>& place, std::string help) {
    const auto read = [name, &place](const std::string& text) {
        const std::vector<double> n = numbersOf(name, text, {3}, "X,Y,Z");
        place = Vec3d(n[0], n[1], n[2]);
    };
    return ofNumbers(ownRow(name, OptionForm::numbers, read, std::move(help)), {3});
}

OptionRow memoryRow(std::uint64_t& bytes) {
    return ownRow(
               "memory", OptionForm::text,
               [&bytes](const std::string& text) { bytes = bytesOf("memory", text); },
               "Memory limit for the cache, as in 4G or 512M: the file is read page by page as "
               "needed; the same picture, slower. Without it the whole file is loaded")
        .typed("SIZE")
        .needing("cache|bake")
        .notCompared();
}

OptionRow bouncesRow(std::optional<int>& bounces) {
    const auto read = [&bounces](const std::string& text) {
        int number = kUnlimitedBounces;
        std::string_view rest = text;
        const bool isNumber = takeNumber(rest, number) && rest.empty();
        if (text != "unlimited" && (!isNumber || number < 0 || number > kMostBounces))
            refuseText("bounces", text,
                       fmt::format("a number from 0 to {}, or unlimited", kMostBounces));
        bounces = number;
    };
    OptionRow row = ownRow("bounces", OptionForm::whole, read,
                           "Surfaces that light may meet before the one that is seen: a number, or "
                           "unlimited; 0: direct light alone [4]");
    row.range = {0, kMostBounces};
    row.orWord = "unlimited";
    return row.typed("B");
}

OptionRow cropRow(std::optional<FilmRectangle>& crop) {
    const auto read = [&crop](const std::string& text) {
        FilmRectangle part;
        std::string_view rest = text;
        if (!takeNumber(rest, part.x) || !takeCharacter(rest, ',') || !takeNumber(rest, part.y) ||
            !takeCharacter(rest, ',') || !takeNumber(rest, part.width) ||
            !(takeCharacter(rest, 'x') || takeCharacter(rest, ',')) ||
            !takeNumber(rest, part.height) || !rest.empty())
            refuseText("crop", text, "X,Y,WxH, as in 100,50,320x180");
        crop = part;
    };
    return ofNumbers(ownRow("crop", OptionForm::numbers, read,
                            "Render only this part of the picture: X,Y,WxH from the upper left "
                            "pixel X,Y; the same pixels as in the whole picture"),
                     {4});
}

OptionRow albedoRow(Rgb& albedo) {
    const auto read = [&albedo](const std::string& text) {
        const std::vector<double> n = numbersOf("albedo", text, {1, 3}, "one value, or R,G,B");
        const Rgb found(n.size() == 1 ? Vec3d(n[0]) : Vec3d(n[0], n[1], n[2]));
        for (int k = 0; k < 3; ++k) requireRange("albedo", found[k], 0.0f, 1.0f);
        albedo = found;
    };
    OptionRow row =
        ownRow("albedo", OptionForm::numbers, read,
               "Albedo of surfaces without vertex colours: one value, or R,G,B, 0 to 1");
    row.range = {0, 1};
    return ofNumbers(row, {1, 3}, numberText(static_cast<double>(albedo.x)));
}

OptionRow materialRow(std::optional<Gloss>& gloss) {
    static const std::pair<const char*, float Gloss::*> kKeys[] = {{"roughness", &Gloss::roughness},
                                                                   {"metallic", &Gloss::metallic},
                                                                   {"ior", &Gloss::ior},
                                                                   {"specular", &Gloss::specular}};
    const auto read = [&gloss](const std::string& text) {
        Gloss found;
        for (std::size_t at = 0; at < text.size();) {
            const std::size_t end = std::min(text.find(',', at), text.size());
            const std::string part = text.substr(at, end - at);
            const std::size_t sign = std::min(part.find('='), part.size());
            const auto key = std::ranges::find(kKeys, part.substr(0, sign),
                                               [](const auto& k) { return std::string(k.first); });
            if (key == std::end(kKeys) || sign == part.size())
                refuseText("material", part,
                           "roughness=, metallic=, ior= or specular= and a number");
            found.*key->second = static_cast<float>(
                numbersOf("material", part.substr(sign + 1), {1}, "a number behind each =")[0]);
            at = end + 1;
        }
        gloss = found;
    };
    OptionRow row =
        ownRow("material", OptionForm::fields, read,
               "Gloss of surfaces without material, as in roughness=0.3,metallic=0: roughness [1] "
               "and metallic [0], 0 to 1; ior [1.5], at least 1; specular [1], 0 to 1");
    for (const auto& [key, part] : kKeys) row.fields.emplace_back(key);
    return row.typed("KEY=VALUE,...");
}

OptionRow estimatorRow(std::optional<std::string>& estimator) {
    OptionRow row = ownRow(
        "estimator", OptionForm::word,
        [&estimator](const std::string& text) { estimator = findEstimator(text).name; },
        "Estimator of direct light [cache with --cache, mis without]:");
    std::string all;
    for (const EstimatorEntry& entry : estimatorTable()) {
        row.help += std::string("\n  ") + entry.name + ": " + entry.summary;
        row.choices.emplace_back(entry.name);
        all += (all.empty() ? "" : ",") + row.choices.back();
    }
    return row.typed("NAME:{" + all + "}");
}

/// An option whose text a part of the library reads, and which is kept as it is.
template <class Check>
OptionRow checkedText(const std::string& name, OptionForm form, std::string& value, Check check,
                      std::string help) {
    const auto read = [&value, check](const std::string& text) {
        check(text);
        value = text;
    };
    OptionRow row = ownRow(name, form, read, std::move(help));
    row.standard = value;
    return row;
}

OptionRow lampRow(std::vector<LampGain>& gains) {
    return ownTextsRow(
               "lamp",
               [&gains](std::span<const std::string> texts) {
                   gains.clear();
                   for (const std::string& text : texts) gains.push_back(parseLampGain(text));
               },
               "Multiply the light of a lamp, or of surfaces with an emissive material: NAME=GAIN, "
               "a factor or R,G,B, 0 to 1e6; * in NAME stands for any text, and the last NAME "
               "that matches counts. --list prints the names")
        .typed("NAME=GAIN");
}

OptionRow lightGroupsRow(std::vector<LightGroupRule>& groups) {
    return ownTextsRow(
               "light-groups",
               [&groups](std::span<const std::string> texts) {
                   groups.clear();
                   for (const std::string& text : texts) groups.push_back(parseLightGroup(text));
               },
               "Write the light of some lamps, or of surfaces with an emissive material, as "
               "channels of their own: NAME, each that matches for itself, or GROUP=NAME; * in "
               "NAME "
               "stands for any text, and the last NAME that matches counts. Together with `sky` "
               "and `rest` they are the picture, of which --mix makes others")
        .typed("NAME");
}

void addSet(Rows& rows, StageOptions& stage) {
    for (OptionRow& row : setRows(stage.set))
        add(rows, row.name == "set-frame" || row.name == "allow-external" ? kSurface : kSet, {row});
    MeshOptions& mesh = stage.set.mesh;
    add(rows, kSurface,
        {wordRow(
             "normals", mesh.shadingNormals, kNormals,
             "shading: the files' normals, where they have some; geometric: each triangle's own")
             .onlyAt({commandLine, serve}),  // in Python they are an array
         numberRow("smooth", mesh.smoothDegrees, {0, 180},
                   "Smooth triangles without shading normals where neighbours differ by at most "
                   "DEGREES, 0 to 180; 0: none")
             .typed("DEGREES"),
         wordRow("surfaces", mesh.gloss, kSurfaces,
                 "glossy: the files' materials, which in glTF reflect like metal, varnish or "
                 "chalk; diffuse: their base colours alone, all chalk"),
         wordRow("lamps", mesh.lamps, kLamps,
                 "on: lamps and surfaces shine as the files say; off: nothing in the set shines"),
         lampRow(mesh.gains)});
    add(rows, kCamera,
        {fpsRow(stage.set.fps),
         dynamicRow(stage.set.dynamic).onlyAt({commandLine, serve}).notCompared()});
}

/// --bake CACHE stands for --cache CACHE once the cache is baked.
OptionRow bakeRow(StageOptions& stage, RunOptions& run) {
    const auto read = [&stage, &run](const std::string& text) {
        stage.cache = text;
        run.bakes = true;
    };
    return ownRow(
               "bake", OptionForm::text, read,
               "Bake the cache of these frames to this file (.vdb), and show first pictures "
               "meanwhile; then render with it as with --cache. A file that is there is used, if "
               "it was baked for these frames. --resume continues a bake that was interrupted")
        .needing("camera")
        .excluding("cache eye debug");
}

void addBake(Rows& rows, StageOptions& stage, RunOptions& run) {
    std::vector<OptionRow> own{
        bakeRow(stage, run),
        option_row::word(
            "bake-quality", [&run](std::size_t i) { run.bakeQuality = kBakeQualities[i]; },
            {std::begin(kBakeQualities), std::end(kBakeQualities)},
            "--quality of the bake, as shadowcache-bake has it [good]")
            .needing("bake"),
        numberRow("bake-spacing", run.bakeSpacing, {0, kMostBakeSpacing},
                  "--spacing of the bake in metres; 0: chosen, by --bake-quality")
            .needing("bake")
            .excluding("bake-quality"),
        flagRow("wait", run.wait, "Show no picture before the cache is baked").needing("bake")};
    for (OptionRow& row : own) add(rows, kRun, {row.onlyAt({commandLine}).notCompared()});
}

void addCache(Rows& rows, StageOptions& stage) {
    add(rows, kQuality,
        {textRow("cache", stage.cache, "Cache of the set, written by shadowcache-bake")
             .notCompared(),
         memoryRow(stage.memory)});
    add(rows, kSampling,
        {flagRow("stale-ok", stage.staleOk,
                 "Accept a cache baked for another set: unbiased, but noisier")});
}

void addLight(Rows& rows, LightOptions& light) {
    add(rows, kSet,
        {textRow(
             "env", light.environment,
             "Lat-long map (EXR or HDR), or a constant radiance R,G,B; for one map per frame: "
             "maps joined by commas, or a sequence with ####; none for a set that shines by itself")
             .onlyAt({commandLine})
             .notCompared(),
         ofNumbers(checkedText("env-rotate", OptionForm::numbers, light.rotation, parseRotation,
                               "Rotation of the map about +Y in degrees, counter-clockwise seen "
                               "from above; A-B: from A in the first frame to B in the last; "
                               "X,Y,Z: about +X, then +Y, then +Z; or the nine numbers of an "
                               "orthogonal matrix, row by row, that takes directions of the map "
                               "to those of the world, reflections included")
                       .named("rotate"),
                   {1, 3, 9}, light.rotation),
         ofNumbers(checkedText("env-gain", OptionForm::numbers, light.gain, gainOf,
                               "What the radiance of the map is multiplied by, a factor or R,G,B; "
                               "0 to 1e6")
                       .named("gain"),
                   {1, 3}, light.gain)});
}

void addCamera(Rows& rows, CameraOptions& camera) {
    add(rows, kCamera,
        {cameraRow(camera.name).excluding("eye"),
         placeRow("eye", camera.eye, "Position of the camera: X,Y,Z").needing("look-at"),
         placeRow("look-at", camera.lookAt, "Point that the camera looks at: X,Y,Z").needing("eye"),
         numberRow("fov-y", camera.fovYDegrees, {0.01, 179},
                   "Vertical field of view in degrees, 0.01 to 179, with --eye")
             .named("", "fov")
             .needing("eye")});
    add(rows, kPicture, {shutterRow(camera.shutter)});
}

void addSize(Rows& rows, RenderOptions& options) {
    add(rows, kCamera, {sizeRow(options.width, options.height).onlyAt({commandLine, python})});
    add(rows, kPicture, {cropRow(options.crop).onlyAt({commandLine, python})});
}

void addRays(Rows& rows, PictureOptions& picture) {
    PixelRays& rays = picture.rays;
    OptionRow spp = wholeRow("spp", rays.spp, 0, kMostCameraRays,
                             "Shadow rays a pixel: as many camera rays with one each")
                        .typed("S")
                        .excluding("target-error camera-rays samples");
    spp.standard = "64";
    add(rows, kQuality,
        {spp, bouncesRow(picture.bounces).inBlender(),
         flagRow("preview", rays.preview,
                 "Show what the cache predicts, and of --spp [4] shadow rays a pixel what they "
                 "add, filtered. Biased, less so with more rays; with --spp 0 a small picture "
                 "with rays corrects it. For a viewport: --preview --spp 1")
             .needing("cache|bake")
             .excluding("target-error debug"),
         numberRow("target-error", rays.targetError, {kLeastTargetError, 1e6},
                   "Choose the camera rays of each part of a frame so that the frame's relMSE "
                   "comes to about this, from a pilot whose numbers the picture does not use; "
                   "--samples is 4 then, unless given")
             .excluding("camera-rays explain")
             .inBlender()});
    add(rows, kSampling,
        {estimatorRow(picture.estimator),
         wholeRow("camera-rays", rays.cameraRays, 1, kMostCameraRays,
                  "Camera rays per pixel (antialiasing), in place of --spp; `cache` sends up to "
                  "16 times as many, with as many fewer samples each, where they are predicted to "
                  "differ [1 with --samples]")
             .inBlender(),
         wholeRow("samples", rays.samples, 0, kMostSamples,
                  "Shadow rays per camera ray, in place of --spp [1 with --camera-rays]; 0 with "
                  "`cache`: what --preview --spp 0 shows")
             .inBlender(),
         wordRow("budget", picture.estimators.cache.adaptive, kBudgets,
                 "uniform: --camera-rays for every pixel, --samples for every camera ray; "
                 "adaptive: about --samples in the mean, allocated by the noise that `cache` "
                 "predicts, and more camera rays where they differ")});
}

void addPicture(Rows& rows, PictureOptions& picture) {
    RenderOptions& options = picture.options;
    addRays(rows, picture);
    add(rows, kOutput,
        {wordsRow("aov", picture.aovs, aovNames(), "Additional channels, joined by commas")
             .named("", "aovs")});
    add(rows, kPicture, {lightGroupsRow(picture.groups)});
    add(rows, kSurface, {albedoRow(options.plain.albedo), materialRow(options.plain.gloss)});
    add(rows, kPicture,
        {flagRow("transparent", options.transparent,
                 "Leave the sky out of the picture and write what the set covers as alpha (A); "
                 "colours are multiplied by it"),
         wordRow("filter", options.filter, kFilters,
                 "Pixel filter of several camera rays: box, gaussian or blackman-harris")
             .inBlender(),
         numberRow("filter-width", options.filterWidth, {0, 16},
                   "Its width in pixels as in Blender; 0: 1 for the box, 1.5 for the others")
             .inBlender()});
    add(rows, kSampling,
        {numberRow("clamp-indirect", options.clampIndirect, {0, 1e30},
                   "Cut the radiance that bounces add to a camera ray at this luminance: no "
                   "fireflies, but darker; 0: unbiased")
             .typed("L")
             .inBlender(),
         wholeRow("pass-rays", options.passRays, 1, kMostCameraRays,
                  "Camera rays of a pixel that are lit together, at most; --progressive writes the "
                  "picture after each such pass"),
         seedRow("seed", options.seed, "Seed of all random numbers").inBlender(),
         wordRow("sequence", picture.sequence, kSequences,
                 "Sample sequence: sobol (Owen-scrambled) or random")});
}

OptionRow runFramesRow(RunOptions& run) {
    std::string none;
    OptionRow row = framesRow(none);
    row.read = [&run](std::span<const std::string> texts) {
        run.frames = parseFrames(texts.back());
        run.framesGiven = true;
    };
    return row;
}

void addOutputs(Rows& rows, RunOptions& run) {
    OptionRow output =
        textRow("output", run.output, "EXR to write (.exr); #### or %04d becomes the frame number");
    output.letter = 'o';
    add(rows, kOutput,
        {output.notCompared(),
         flagRow("png", run.png,
                 "Also write an sRGB PNG for each EXR, and one in false colour for the AOVs "
                 "openness, expected_noise, items and misses")
             .notCompared(),
         numberRow("exposure", run.exposure, {-64, 64}, "Exposure of the PNG in stops")
             .notCompared(),
         flagRow("resume", run.resume,
                 "Skip frames that are complete and were rendered from the same settings and files")
             .notCompared(),
         threadsRow(run.threads)});
    add(rows, kPicture,
        {flagRow("half", run.half, "16-bit channels instead of 32-bit"),
         wordRow(
             "aov-names", run.aovNames, kAovNamings,
             "Names of the AOVs' channels: shadowcache, or arnold, by which its denoiser noice "
             "finds normal (N), axial_depth (Z), diffuse_color (diffuse_albedo) and variance")});
}

OptionRow debugRow(std::optional<std::array<int, 2>>& pixel) {
    return ownRow(
               "debug", OptionForm::numbers,
               [&pixel](const std::string& text) { pixel = pairOf("debug", text, "a pixel, X,Y"); },
               "Print the samples of pixel X,Y; write no picture")
        .notKept();
}

OptionRow mixRow(std::filesystem::path& picture) {
    return textRow("mix", picture,
                   "Make the picture of other gains out of one that has light groups, an EXR of "
                   "--light-groups; render nothing")
        .notKept();
}

OptionRow gainRow(std::vector<LampGain>& gains) {
    return ownTextsRow(
               "gain",
               [&gains](std::span<const std::string> texts) {
                   gains.clear();
                   for (const std::string& text : texts)
                       gains.push_back(parseLampGain(text, "gain"));
               },
               "With --mix: multiply the light of a group by a factor or R,G,B, 0 to 1e6; * in "
               "NAME stands for any text, and the last NAME that matches counts. The sky's group "
               "is `sky`")
        .typed("NAME=GAIN")
        .needing("mix")
        .notKept();
}

OptionRow timeLimitRow(double& seconds) {
    OptionRow row = numberRow(
        "time-limit", seconds, {0, 1e9},
        "Seconds for the passes of a frame; the first is always completed. What --target-error "
        "plans before them is not counted");
    row.standard.clear();  // none
    return row.needing("progressive");
}

void addRun(Rows& rows, RunOptions& run) {
    add(rows, kCamera, {runFramesRow(run).notCompared()});
    addOutputs(rows, run);
    add(rows, kPicture,
        {ownRow(
             "shot-frames", OptionForm::text,
             [&run](const std::string& text) {
                 run.shotFrames = parseFrames(text, "--shot-frames");
             },
             "Frames that the maps of --env and the turn of --env-rotate are spread over, if "
             "--frames are a part of them [those of --frames]")
             .notCompared()});
    add(rows, kRun,
        {flagRow("list", run.list,
                 "Print cameras, lamps, animations and sizes of a glTF set, and exit"),
         flagRow("serve", run.serve,
                 "Stay, and render what requests on standard input ask for, as docs/serve.md has "
                 "them; beside it only --threads counts")
             .notKept(),
         mixRow(run.mix), gainRow(run.gains),
         flagRow("explain", run.explain,
                 "Print the estimator, its inputs, and the expected noise and time; write no "
                 "picture")
             .notKept(),
         flagRow("check", run.check,
                 "Render nothing: verify that every frame is complete and was rendered from the "
                 "same settings and files; the exit status is 1 if one is not")
             .notKept(),
         flagRow("progressive", run.progressive,
                 "Render in passes of --pass-rays camera rays a pixel and write the EXR after "
                 "each; Ctrl-C ends with the last pass that is complete, a second one at once")
             .notCompared(),
         timeLimitRow(run.timeLimit),
         textRow("reference", run.reference,
                 "EXR to compare with; reports the relative error on standard output and in "
                 "--stats")
             .notCompared(),
         textRow("stats", run.stats, "Write times, rays and memory as JSON").notCompared(),
         debugRow(run.debugPixel), progressRow()});
}

Rows runRows(RunOptions& run) {
    Rows rows;
    addRun(rows, run);
    for (OptionRow& row : rows) row.onlyAt({commandLine});
    return rows;
}

}  // namespace

std::vector<OptionRow> optionRows(Part part, RenderJob& job) {
    Rows rows;
    switch (part) {
        case Part::set:
            addSet(rows, job.stage);
            break;
        case Part::cache:
            addCache(rows, job.stage);
            addBake(rows, job.stage, job.run);
            break;
        case Part::light:
            addLight(rows, job.light);
            break;
        case Part::camera:
            addCamera(rows, job.camera);
            break;
        case Part::size:
            addSize(rows, job.picture.options);
            break;
        case Part::picture:
            addPicture(rows, job.picture);
            break;
        case Part::run:
            return runRows(job.run);
    }
    return rows;
}

std::vector<OptionRow> optionRows(RenderJob& job) {
    Rows all;
    for (const Part part :
         {Part::set, Part::light, Part::camera, Part::size, Part::cache, Part::picture, Part::run})
        for (OptionRow& row : optionRows(part, job)) all.push_back(std::move(row));
    return all;
}

std::span<const OptionRow> optionTable() {
    static RenderJob job;
    static const Rows kRows = optionRows(job);
    return kRows;
}

std::string inWordsOf(Door door, const std::string& message) {
    return inWordsOf(door, optionTable(), message);
}

}  // namespace shadowcache
