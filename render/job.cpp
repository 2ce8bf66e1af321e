#include "render/job.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <regex>
#include <sstream>

#include "common/atomic_file.h"
#include "common/error.h"
#include "common/json_file.h"
#include "common/option_checks.h"
#include "common/parallel.h"
#include "common/process.h"
#include "common/progress.h"
#include "common/version.h"
#include "render/camera.h"
#include "render/compare.h"
#include "render/integrator.h"
#include "render/pixel_report.h"

namespace shadowcache {

namespace {

/// "R,G,B" -> one colour.
std::optional<Rgb> parseColor(const std::string& text) {
    Rgb c;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%f,%f,%f%c", &c.x, &c.y, &c.z, &rest) != 3) return std::nullopt;
    for (int k = 0; k < 3; ++k)
        if (!(c[k] >= 0) || std::isinf(c[k]))
            throw Error("--env " + text + ": wanted three radiances of 0 or more");
    return c;
}

Environment loadEnvironment(const RenderJob& job) {
    if (const auto color = parseColor(job.environment))
        return Environment({1, 1, {*color}}, 0, Rgb(0.2126f, 0.7152f, 0.0722f));
    const RadianceImage map = readRadiance(job.environment);
    if (map.image.width != 2 * map.image.height)
        std::fprintf(stderr,
                     "shadowcache-render: warning: %s: %dx%d texels, a lat-long map is 2:1\n",
                     job.environment.c_str(), map.image.width, map.image.height);
    if (map.notFinite + map.negative > 0)
        std::printf("map: %zu texels not finite and %zu negative, set to 0\n", map.notFinite,
                    map.negative);
    return Environment(map.image, job.environmentRotation, map.luminanceWeights);
}

/// The cache, if it is of this set.
std::unique_ptr<ShadowCache> openCache(const RenderJob& job, const TriangleMesh& mesh) {
    if (job.cache.empty()) return nullptr;
    auto cache = std::make_unique<ShadowCache>(job.cache);
    if (cache->header().fingerprint == fingerprint(mesh)) return cache;
    if (!job.staleOk)
        throwFileError(job.cache,
                       "baked for another set (its fingerprint differs): bake this set, or use the "
                       "cache all the same with --stale-ok, at the price of noise");
    std::fprintf(stderr,
                 "shadowcache-render: warning: %s: baked for another set; unbiased, but noisier\n",
                 job.cache.c_str());
    return cache;
}

Camera cameraOf(const RenderJob& job, const CameraTrack* track, int frame) {
    if (track) return cameraAtFrame(*track, frame);
    // A plan has its north, -Z, at the top.
    const bool vertical = job.eye->x == job.lookAt->x && job.eye->z == job.lookAt->z;
    const Vec3d up = vertical ? Vec3d(0, 0, -1) : Vec3d(0, 1, 0);
    return lookAt(*job.eye, *job.lookAt, up, job.fovYDegrees * kPi / 180);
}

struct Timing {
    double load = 0, build = 0;
};

Metadata frameMetadata(const RenderJob& job, const EstimatorEntry& entry, const ShadowCache* cache,
                       double seconds, int frame) {
    Metadata metadata{{"shadowcache:version", kVersion}};
    for (const auto& [name, value] : job.settings)
        metadata.emplace_back("shadowcache:" + name, value);
    metadata.emplace_back("shadowcache:bias", biasOf(entry, job.render.samples));
    metadata.emplace_back("shadowcache:frame", std::to_string(frame));
    metadata.emplace_back("shadowcache:seconds", std::to_string(seconds));
    if (cache) {
        std::ostringstream print;
        print << std::hex << cache->header().fingerprint;
        metadata.emplace_back("shadowcache:fingerprint", print.str());
    }
    return metadata;
}

void writeFrame(const RenderJob& job, const EstimatorEntry& entry, const Film& film,
                const ShadowCache* cache, double seconds, int frame) {
    const auto path = framePath(job.output, frame, job.frames.size() > 1);
    writeExr(path, film.width, film.height, channels(film, job.aovs),
             frameMetadata(job, entry, cache, seconds, frame),
             job.half ? PixelType::half : PixelType::full);
    if (!job.png) return;
    auto png = path;
    writePng(png.replace_extension(".png"), colorImage(film), job.exposure);
}

void writeStats(const RenderJob& job, const EstimatorEntry& entry, const TriangleMesh& mesh,
                const ShadowCache* cache, const Timing& timing, const RenderStats& stats,
                const std::optional<RelativeError>& error) {
    JsonFile out;
    out.set("version", std::string(kVersion));
    out.set("estimator", std::string(entry.name));
    out.set("bias", biasOf(entry, job.render.samples));
    out.set("triangles", std::uint64_t{mesh.triangles.size()});
    out.set("seconds.load", timing.load);
    out.set("seconds.build", timing.build);
    // Set-up and tracing are kept per thread; the rest is the camera's rays and the film.
    out.set("seconds.render", stats.seconds);
    out.set("seconds.setup", stats.setupSeconds);
    out.set("seconds.trace", stats.traceSeconds);
    out.set("rays.camera", stats.cameraRays);
    out.set("rays.shadow", stats.shadowRays);
    out.set("cache.items", std::uint64_t{cache ? cache->itemCount() : 0});
    out.set("cache.bytes", std::uint64_t{cache ? cache->memoryBytes() : 0});
    if (error) {
        out.set("error.relmse", error->mean);
        out.set("error.l2", error->l2);
        out.set("error.p50", error->p50);
        out.set("error.p99", error->p99);
        out.set("error.max", error->max);
    }
    out.set("peak_rss_bytes", peakMemoryBytes());
    out.write(job.stats);
}

/// The R, G and B of a rendered image, negative estimates included.
Image readReference(const std::filesystem::path& path, const RenderOptions& picture) {
    const ExrFile file = readExr(path);
    if (file.width != picture.width || file.height != picture.height)
        throwFileError(path, std::to_string(file.width) + "x" + std::to_string(file.height) +
                                 " pixels, wanted " + std::to_string(picture.width) + "x" +
                                 std::to_string(picture.height) + " as rendered");
    Image image{file.width, file.height, {}};
    image.pixels.resize(static_cast<std::size_t>(file.width) *
                        static_cast<std::size_t>(file.height));
    const std::string names = "RGB";
    for (int k = 0; k < 3; ++k) {
        const auto found =
            std::find_if(file.channels.begin(), file.channels.end(), [&](const Channel& c) {
                return c.name == names.substr(static_cast<std::size_t>(k), 1);
            });
        if (found == file.channels.end())
            throwFileError(path, "no channels R, G and B to compare with");
        for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i][k] = found->values[i];
    }
    return image;
}

void validateOutputs(const RenderJob& job) {
    requireExtension(job.output, ".exr");
    channels(Film{}, job.aovs);
    for (const int frame : job.frames) {
        auto path = framePath(job.output, frame, job.frames.size() > 1);
        requireWritable(path);
        if (job.png) requireWritable(path.replace_extension(".png"));
    }
    if (!job.stats.empty()) requireWritable(job.stats);
}

/// Whatever can be refused is refused before the long work.
///
/// @return the estimator asked for
const EstimatorEntry& validate(const RenderJob& job) {
    validate(job.render);
    validate(job.estimatorOptions);
    requireRange("threads", job.threads, 0, kMaxThreads);
    requireRange("env-rotate", job.environmentRotation, -1e6, 1e6);
    requireRange("exposure", job.exposure, -64.0f, 64.0f);
    requireRange("fov-y", job.fovYDegrees, 0.01, 179.0);
    if (job.debugPixel) {
        requireRange("debug (x)", (*job.debugPixel)[0], 0, job.render.width - 1);
        requireRange("debug (y)", (*job.debugPixel)[1], 0, job.render.height - 1);
    }
    const std::string name =
        !job.estimator.empty() ? job.estimator : (job.cache.empty() ? "mis" : "cache");
    const EstimatorEntry& entry = findEstimator(name);
    if (entry.needsCache && job.cache.empty())
        throw Error("--estimator " + name +
                    " needs --cache: bake the set with shadowcache-bake first");
    if (job.render.samples < entry.minSamples)
        throw Error("--samples " + std::to_string(job.render.samples) + ": --estimator " + name +
                    " wants at least " + std::to_string(entry.minSamples));
    validateOutputs(job);
    return entry;
}

}  // namespace

std::vector<int> parseFrames(const std::string& text) {
    static const std::regex range(R"((\d{1,7})(?:-(\d{1,7})(?:x(\d{1,7}))?)?)");
    std::vector<int> frames;
    std::istringstream parts(text);
    std::string part;
    while (std::getline(parts, part, ',')) {
        std::smatch match;
        const bool matched = std::regex_match(part, match, range);
        const int first = matched ? std::stoi(match[1]) : 0;
        const int last = matched && match[2].matched ? std::stoi(match[2]) : first;
        const int step = matched && match[3].matched ? std::stoi(match[3]) : 1;
        if (!matched || last < first || step < 1)
            throw Error("--frames " + text +
                        ": wanted A, A-B or A-BxSTEP with A <= B, several joined by commas");
        for (int f = first; f <= last; f += step) frames.push_back(f);
    }
    if (frames.empty()) throw Error("--frames: empty, wanted A, A-B or A-BxSTEP");
    return frames;
}

std::filesystem::path framePath(const std::filesystem::path& pattern, int frame, bool several) {
    std::string name = pattern.filename().string();
    static const std::regex printfStyle(R"(%0?(\d?)d)");
    std::smatch match;
    std::size_t at = name.find('#'), length = 0;
    int width = 0;
    if (at != std::string::npos) {
        while (at + length < name.size() && name[at + length] == '#') ++length;
        width = static_cast<int>(length);
    } else if (std::regex_search(name, match, printfStyle)) {
        at = static_cast<std::size_t>(match.position(0));
        length = static_cast<std::size_t>(match.length(0));
        width = match[1].length() ? std::stoi(match[1]) : 1;
    } else {
        if (several)
            throw Error("--output " + pattern.string() +
                        ": several frames need a place for their number, as in frame.####.exr");
        return pattern;
    }
    char number[32];
    std::snprintf(number, sizeof number, "%0*d", width, frame);
    return pattern.parent_path() / name.replace(at, length, number);
}

void run(const RenderJob& job) {
    const EstimatorEntry& entry = validate(job);
    setThreadCount(job.threads);
    installInterruptHandler();

    const double start = secondsNow();
    std::optional<CameraTrack> track;
    if (!job.cameraFile.empty()) track = readCameraFile(job.cameraFile);
    const auto camera = [&](int frame) { return cameraOf(job, track ? &*track : nullptr, frame); };
    for (const int frame : job.frames) camera(frame);
    std::optional<Image> reference;
    if (!job.reference.empty()) reference = readReference(job.reference, job.render);
    const TriangleMesh mesh = loadMesh(job.files, job.mesh);
    std::printf("set: %s\n", describe(mesh.report).c_str());
    const auto cache = openCache(job, mesh);
    const Environment environment = loadEnvironment(job);
    const double loaded = secondsNow();
    const Scene scene(mesh);
    const EstimatorContext context{scene, environment, cache.get(), job.estimatorOptions};
    const std::unique_ptr<Estimator> estimator = entry.make(context);
    if (job.debugPixel && estimator->inOrder())
        throw Error(std::string("--debug: a pixel of --estimator ") + entry.name +
                    " depends on the pixels before it and has no story of its own");
    const Timing timing{loaded - start, secondsNow() - loaded};

    RenderStats stats;
    std::optional<RelativeError> error;
    for (const int frame : job.frames) {
        throwIfInterrupted();
        const double before = stats.seconds;
        survey(*estimator, context, camera(frame), frame, job.render, stats);
        if (job.debugPixel) {
            const auto [x, y] = *job.debugPixel;
            reportPixel(*estimator, context, camera(frame), frame, job.render, x, y);
            continue;
        }
        const Film film = render(*estimator, context, camera(frame), frame, job.render, stats);
        writeFrame(job, entry, film, cache.get(), stats.seconds - before, frame);
        if (reference) error = relativeError(colorImage(film), *reference);
    }
    if (job.debugPixel) return;
    std::printf("%s: %zu frame%s, %d samples, %.1f M shadow rays in %.2f s", entry.name,
                job.frames.size(), job.frames.size() > 1 ? "s" : "", job.render.samples,
                static_cast<double>(stats.shadowRays) * 1e-6, stats.seconds);
    if (error) std::printf(", relMSE %.3g", error->mean);
    std::printf(" -> %s\n", job.output.c_str());
    if (!job.stats.empty()) writeStats(job, entry, mesh, cache.get(), timing, stats, error);
}

}  // namespace shadowcache
