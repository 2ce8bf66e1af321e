#include "tests/benchmarks/bench.h"

#include <fmt/core.h>

#include <cmath>
#include <cstdio>
#include <ctime>
#include <map>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/base/process.h"
#include "common/image/exr.h"
#include "common/image/radiance.h"
#include "common/import/load_mesh.h"
#include "common/mesh/mesh_fingerprint.h"
#include "common/shot/camera_file.h"
#include "render/frame/pilot.h"
#include "render/table/estimator_table.h"

namespace shadowcache::bench {

namespace {

const std::map<std::string, std::string>& sceneFiles() {
    static const std::map<std::string, std::string> files{{"kitchen", "luxcore_kitchen"},
                                                          {"atrium", "gen_atrium"},
                                                          {"grove", "gen_grove"},
                                                          {"dragon", "dragon_871k_plane"},
                                                          {"armadillo", "armadillo_plane"}};
    return files;
}

constexpr const char* kSamplesKey = "bench:samples";
/// Error of the reference itself, in millionths.
constexpr const char* kErrorKey = "bench:own_error_ppm";
constexpr double kErrorUnit = 1e6;

/// A reference that an earlier run left, if it has as many samples and pixels.
std::optional<Reference> storedReference(const std::filesystem::path& path,
                                         const std::string& samples, const FilmRectangle& region) {
    if (!std::filesystem::exists(path)) return std::nullopt;
    const ExrFile file = readExr(path);
    const auto made = file.metadata.find(kSamplesKey), error = file.metadata.find(kErrorKey);
    if (made == file.metadata.end() || error == file.metadata.end() || made->second != samples ||
        file.width != region.width || file.height != region.height)
        return std::nullopt;
    Reference reference{{file.width, file.height, {}}, std::stod(error->second) / kErrorUnit};
    reference.image.pixels.resize(file.channels.at(0).values.size());
    for (const Channel& channel : file.channels) {
        const std::size_t k = std::string("RGB").find(channel.name);
        for (std::size_t i = 0; k < 3 && i < channel.values.size(); ++i)
            reference.image.pixels[i][static_cast<int>(k)] = channel.values[i];
    }
    return reference;
}

}  // namespace

std::filesystem::path mapFile(const Settings& settings, const std::string& name) {
    for (const char* suffix : {".exr", "_1k.exr"}) {
        const auto path = settings.data / "env" / (name + suffix);
        if (std::filesystem::exists(path)) return path;
    }
    throw Error("no map " + name + ".exr in " + (settings.data / "env").string());
}

SetFiles setFiles(const Settings& settings, const std::string& name) {
    const auto known = sceneFiles().find(name);
    const std::string stem = known == sceneFiles().end() ? name : known->second;
    const std::filesystem::path folder = settings.data / "scene";
    return {folder / (stem + ".ply"), folder / (stem + "_cameras.json")};
}

std::unique_ptr<Set> loadSet(const Settings& settings, const std::string& name) {
    const SetFiles files = setFiles(settings, name);
    auto set = std::make_unique<Set>();
    set->name = name;
    set->mesh = loadMesh({&files.mesh, 1}, {});
    set->cameras = readCameraFile(files.cameras);
    set->scene = std::make_unique<Scene>(set->mesh);
    return set;
}

std::unique_ptr<Environment> loadMap(const Settings& settings, const std::string& name) {
    const RadianceImage map = readRadiance(mapFile(settings, name));
    return std::make_unique<Environment>(map.image, 0, map.luminanceWeights);
}

BakedCache bakeCache(const Settings& settings, const Set& set, const BakeOptions& options,
                     const std::string& tag) {
    std::filesystem::create_directories(settings.work);
    const auto path = settings.work / (set.name + "-" + tag + ".vdb");
    const double start = secondsNow();
    const BakeResult result = bake(*set.scene, options);
    BakedCache baked;
    baked.seconds = secondsNow() - start;
    baked.rays = static_cast<double>(result.rays);
    baked.fileBytes = static_cast<double>(writeCache(path, result.header, result.items));
    baked.cache = std::make_unique<ShadowCache>(path);
    return baked;
}

BakedCache keptCache(const Settings& settings, const Set& set) {
    const BakeOptions& o = settings.bake;
    char tag[80];
    std::snprintf(tag, sizeof tag, "kept-%g-%d-%d", o.spacing, o.level, o.rays);
    const auto path = settings.work / (set.name + "-" + tag + ".vdb");
    if (!std::filesystem::exists(path)) return bakeCache(settings, set, o, tag);
    BakedCache kept;
    kept.cache = std::make_unique<ShadowCache>(path);
    if (kept.cache->header().fingerprint != fingerprint(set.mesh))
        throwFileError(path, "baked for another set: delete it");
    return kept;
}

void forEachFrame(const Settings& settings, const std::function<void(const Frame&)>& measure) {
    for (const std::string& sceneName : settings.scenes) {
        const auto set = loadSet(settings, sceneName);
        const BakedCache baked = keptCache(settings, *set);
        for (const std::string& mapName : settings.maps) {
            const auto environment = loadMap(settings, mapName);
            const EstimatorContext context{*set->scene, *environment, baked.cache.get(), {}};
            for (const int frame : settings.frames) measure({context, *set, mapName, frame});
        }
    }
}

Settings fullMatrix(Settings settings) {
    settings.maps = {"courtyard", "sunrise",        "circus_arena",
                     "interior",  "kloppenheim_05", "aristea_wreck_puresky"};
    settings.frames = {1, 120};
    return settings;
}

namespace {

Rendered renderAs(const EstimatorContext& context, const Set& set, const std::string& estimator,
                  int frame, const RenderOptions& options, const EstimatorOptions& estimatorOptions,
                  bool sameRays) {
    const auto made = findEstimator(estimator).make(context, estimatorOptions);
    Rendered rendered;
    const Camera camera = cameraAtFrame(set.cameras, frame);
    const std::clock_t start = std::clock();
    FrameRequest request{*made, camera, frame, options};
    request.plan = planFrame(request, rendered.stats);
    if (sameRays && request.plan.antialiasing) request.plan.antialiasing->most = 1;
    rendered.image = colorImage(render(request, rendered.stats));
    rendered.processorSeconds =
        static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / threadCount();
    return rendered;
}

}  // namespace

Rendered renderWith(const EstimatorContext& context, const Set& set, const std::string& estimator,
                    int frame, const RenderOptions& options,
                    const EstimatorOptions& estimatorOptions) {
    return renderAs(context, set, estimator, frame, options, estimatorOptions, false);
}

Rendered renderWithSameRays(const EstimatorContext& context, const Set& set,
                            const std::string& estimator, int frame, const RenderOptions& options) {
    return renderAs(context, set, estimator, frame, options, {}, true);
}

Rendered renderFrame(const EstimatorContext& context, const Set& set, const std::string& estimator,
                     int frame, int samples, std::uint64_t seed, const Settings& settings,
                     const EstimatorOptions& estimatorOptions) {
    RenderOptions options;
    options.width = settings.width;
    options.height = settings.height;
    options.samples = samples;
    options.seed = seed;
    return renderWith(context, set, estimator, frame, options, estimatorOptions);
}

Reference makeReference(const EstimatorContext& context, const Set& set, int frame, int samples,
                        const Settings& settings, const std::string& tag) {
    RenderOptions options;
    options.width = settings.width;
    options.height = settings.height;
    options.samples = samples;
    return makeReference(context, set, frame, options, settings.work, tag);
}

Reference makeReference(const EstimatorContext& context, const Set& set, int frame,
                        const RenderOptions& options, const std::filesystem::path& work,
                        const std::string& tag, int renders) {
    const std::filesystem::path path = work / (tag + "-reference.exr");
    const std::string samples = fmt::format(
        "{}{}{}", renders > 2 ? fmt::format("{}x", renders) : "",
        options.cameraRays > 1 ? fmt::format("{}x", options.cameraRays) : "", options.samples);
    if (const auto stored = storedReference(path, samples, options.region())) return *stored;
    std::vector<Image> images;
    RenderOptions one = options;
    for (int i = 1; i <= renders; ++i) {
        one.seed = 1000 + static_cast<std::uint64_t>(i);
        images.push_back(renderWith(context, set, "cache", frame, one).image);
    }
    const Image& first = images.front();
    const auto count = static_cast<float>(renders);
    Reference reference{first, 0};
    // The mean varies by what the renders vary about it, over their number and one less.
    Image difference = first;
    for (std::size_t i = 0; i < first.pixels.size(); ++i) {
        Rgb mean(0, 0, 0), squares(0, 0, 0);
        for (const Image& image : images) mean += image.pixels[i] / count;
        for (const Image& image : images) {
            const Rgb d = image.pixels[i] - mean;
            squares += d * d / (count * (count - 1));
        }
        reference.image.pixels[i] = mean;
        for (int k = 0; k < 3; ++k) difference.pixels[i][k] = mean[k] + std::sqrt(squares[k]);
    }
    reference.ownError = relativeError(difference, reference.image).mean;
    std::vector<Channel> channels{{"R", {}}, {"G", {}}, {"B", {}}};
    for (const Rgb& p : reference.image.pixels)
        for (int k = 0; k < 3; ++k) channels[static_cast<std::size_t>(k)].values.push_back(p[k]);
    writeExr(path, first.width, first.height, channels,
             {{kSamplesKey, samples}, {kErrorKey, std::to_string(reference.ownError * kErrorUnit)}},
             PixelType::full);
    return reference;
}

}  // namespace shadowcache::bench
