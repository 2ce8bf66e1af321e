#include "render/job.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <sstream>

#include "common/atomic_file.h"
#include "common/error.h"
#include "common/json_file.h"
#include "common/mesh_reader.h"
#include "common/option_checks.h"
#include "common/parallel.h"
#include "common/process.h"
#include "common/progress.h"
#include "common/version.h"
#include "render/aov_pictures.h"
#include "render/camera.h"
#include "render/compare.h"
#include "render/explain.h"
#include "render/frames.h"
#include "render/gltf_shot.h"
#include "render/integrator.h"
#include "render/light_plan.h"
#include "render/memory_report.h"
#include "render/pixel_report.h"
#include "render/resume.h"
#include "render/target_error.h"

namespace shadowcache {

namespace {

/// The cache, if it is of this set.
std::unique_ptr<ShadowCache> openCache(const RenderJob& job, const TriangleMesh& mesh) {
    if (job.cache.empty()) return nullptr;
    auto cache = std::make_unique<ShadowCache>(job.cache, job.memory);
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

/// Cameras of a job, by frame.
class CameraSource {
public:
    CameraSource(const RenderJob& job, std::span<const GltfShot> shots) : job_(job) {
        if (job.camera.empty()) return;
        if (shots.empty() || std::filesystem::path(job.camera).extension() == ".json")
            track_ = readCameraFile(job.camera);
        else
            named_ = findCamera(shots, job.camera);
    }

    Camera at(int frame) const {
        if (track_) return cameraAtFrame(*track_, frame);
        if (named_.shot) return named_.shot->camera(named_.node, frame);
        // A plan has its north, -Z, at the top.
        const bool vertical = job_.eye->x == job_.lookAt->x && job_.eye->z == job_.lookAt->z;
        const Vec3d up = vertical ? Vec3d(0, 0, -1) : Vec3d(0, 1, 0);
        return lookAt(*job_.eye, *job_.lookAt, up, job_.fovYDegrees * kPi / 180);
    }

private:
    const RenderJob& job_;
    std::optional<CameraTrack> track_;
    NamedCamera named_;
};

std::vector<GltfShot> openShots(const RenderJob& job) {
    std::vector<GltfShot> shots;
    for (const auto& file : job.files)
        if (isGltf(file)) shots.emplace_back(file, job.mesh, job.fps);
    return shots;
}

/// Files whose change makes a picture another one.
std::vector<std::filesystem::path> inputsOf(const RenderJob& job, const LightPlan::Light& light) {
    std::vector<std::filesystem::path> inputs = job.files;
    for (const DynamicFile& file : job.dynamic) {
        inputs.push_back(file.mesh);
        inputs.push_back(file.track);
    }
    for (const std::string& text : {job.cache.string(), job.camera, light.environment})
        inputs.emplace_back(text);
    return inputs;
}

struct Timing {
    double load = 0, build = 0;
};

/// All that a frame's file tells but the time it took.
Metadata frameMetadata(const RenderJob& job, const EstimatorEntry& entry, const ShadowCache* cache,
                       const LightPlan::Light& light, int frame) {
    Metadata metadata{{"shadowcache:version", kVersion}};
    for (const auto& [name, value] : job.settings)
        if (name != "env" && name != "env-rotate")
            metadata.emplace_back("shadowcache:" + name, value);
    std::ostringstream angle;
    angle.precision(17);
    angle << light.rotation;
    metadata.emplace_back("shadowcache:env", light.environment);
    metadata.emplace_back("shadowcache:env-rotate", angle.str());
    metadata.emplace_back("shadowcache:bias", biasOf(entry, job.render.samples));
    metadata.emplace_back("shadowcache:frame", std::to_string(frame));
    metadata.emplace_back("shadowcache:inputs", inputsMark(inputsOf(job, light)));
    if (cache) {
        std::ostringstream print;
        print << std::hex << cache->header().fingerprint;
        metadata.emplace_back("shadowcache:fingerprint", print.str());
    }
    return metadata;
}

void writeFrame(const RenderJob& job, const Film& film, Metadata metadata, double seconds,
                int frame) {
    const auto path = framePath(job.output, frame, job.frames.size() > 1);
    metadata.emplace_back("shadowcache:seconds", std::to_string(seconds));
    writeExr(path, film.width, film.height, channels(film, job.aovs), metadata,
             job.half ? PixelType::half : PixelType::full);
    if (!job.png) return;
    auto png = path;
    writePng(png.replace_extension(".png"), colorImage(film), job.exposure);
    for (const auto& [aov, picture] : aovPictures(png, job.aovs))
        writePng(picture, falseColorImage(film, aov), 0);
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
    if (cache) addMemoryUse(out, cache->memoryUse());
    out.set("samples", static_cast<std::uint64_t>(stats.samples));
    out.set("error.by_own_variance", stats.ownError);
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

void validateOutputs(const RenderJob& job, const EstimatorEntry& entry) {
    requireExtension(job.output, ".exr");
    for (const std::string& aov : job.aovs)
        if (needsInsight(aov) && !entry.needsCache)
            throw Error("--aov " + aov + ": wanted --estimator cache, which alone knows it");
    for (const int frame : job.frames) {
        auto path = framePath(job.output, frame, job.frames.size() > 1);
        requireWritable(path);
        if (!job.png) continue;
        requireWritable(path.replace_extension(".png"));
        for (const auto& [aov, picture] : aovPictures(path, job.aovs)) requireWritable(picture);
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
    requireRange("fps", job.fps, 1e-3, 1e6);
    requireRange("target-error", job.targetError, 0.0, 1e6);
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
    validateOutputs(job, entry);
    return entry;
}

/// A job under way: what is loaded once, and the frames.
class Shot {
public:
    explicit Shot(const RenderJob& job)
        : job_(job),
          entry_(validate(job)),
          plan_(job.environment, job.environmentRotation, job.frames),
          light_(plan_) {
        setThreadCount(job.threads);
        installInterruptHandler();
    }

    void run() {
        const double start = secondsNow();
        plan_.requireFiles();
        std::vector<GltfShot> shots = openShots(job_);
        const CameraSource camera(job_, shots);
        for (const int frame : job_.frames) camera.at(frame);
        if (!job_.reference.empty()) reference_ = readReference(job_.reference, job_.render);
        mesh_ = loadMesh(job_.files, job_.mesh);
        std::printf("set: %s\n", describe(mesh_.report).c_str());
        moving_.emplace(shots, job_.dynamic, job_.mesh, mesh_.origin, job_.fps);
        for (const int frame : job_.frames) moving_->requireFrame(frame);
        for (GltfShot& shot : shots) shot.dropData();
        if (!moving_->empty())
            std::printf("moving: %zu triangles, which are not in the cache\n",
                        moving_->triangles());
        cache_ = openCache(job_, mesh_);
        const double loaded = secondsNow();
        scene_.emplace(mesh_);
        timing_ = {loaded - start, secondsNow() - loaded};
        options_ = job_.render;
        options_.insight = std::ranges::any_of(job_.aovs, needsInsight);
        for (std::size_t i = 0; i < job_.frames.size(); ++i) {
            frame(camera, i);
            if (job_.explain) return;
        }
        if (job_.debugPixel) return;
        summarize();
        if (!job_.stats.empty())
            writeStats(job_, entry_, mesh_, cache_.get(), timing_, stats_, error_);
    }

private:
    void frame(const CameraSource& camera, std::size_t i) {
        throwIfInterrupted();
        const int frame = job_.frames[i];
        Metadata metadata = frameMetadata(job_, entry_, cache_.get(), plan_.at(i), frame);
        if (job_.resume && !job_.explain && isDone(metadata, frame)) return;
        const double start = secondsNow();
        if (light_.turnTo(i)) {
            context_.reset(new EstimatorContext{*scene_, light_.environment(), cache_.get(),
                                                job_.estimatorOptions});
            estimator_ = entry_.make(*context_);
        }
        if (job_.debugPixel && estimator_->inOrder())
            throw Error(std::string("--debug: a pixel of --estimator ") + entry_.name +
                        " depends on the pixels before it and has no story of its own");
        timing_.build += secondsNow() - start;
        scene_->setMoving(moving_->pose(frame));
        const double before = stats_.seconds;
        const Camera view = camera.at(frame);
        if (job_.explain) {
            const Forecast forecast{entry_, !job_.estimator.empty(),
                                    static_cast<int>(job_.frames.size()),
                                    timing_.load + timing_.build};
            std::fputs(explain(*estimator_, *context_, view, frame, options_, forecast).c_str(),
                       stdout);
            return;
        }
        RenderOptions options = options_;
        if (job_.targetError > 0)
            options.samples = samplesForError(*estimator_, *context_, view, frame, options_,
                                              job_.targetError, stats_);
        else
            survey(*estimator_, *context_, view, frame, options, stats_);
        if (job_.debugPixel) {
            const auto [x, y] = *job_.debugPixel;
            reportPixel(*estimator_, *context_, view, frame, options, x, y);
            return;
        }
        const Film film = render(*estimator_, *context_, view, frame, options, stats_);
        stats_.samples = options.samples;
        stats_.ownError = measuredError(film.pixels, context_->environment.luminanceWeights());
        if (job_.targetError > 0) reportError(frame);
        writeFrame(job_, film, std::move(metadata), stats_.seconds - before, frame);
        ++rendered_;
        if (reference_) error_ = relativeError(colorImage(film), *reference_);
    }

    /// Says what the frame's own samples tell of its error.
    void reportError(int frame) const {
        std::printf("frame %d: %d samples, relMSE %.3g by its own variance, wanted %.3g%s\n", frame,
                    stats_.samples, stats_.ownError, job_.targetError,
                    stats_.samples == kMostSamples ? " (no more samples are allowed)" : "");
    }

    /// Whether the frame is there as it would be rendered; counts and tells what is not.
    bool isDone(const Metadata& metadata, int frame) {
        auto path = framePath(job_.output, frame, job_.frames.size() > 1);
        const FrameState state = frameState(path, metadata);
        if (state == FrameState::broken) std::printf("%s: broken, rendered again\n", path.c_str());
        if (state == FrameState::changed)
            std::printf("%s: of other settings or files, rendered again\n", path.c_str());
        if (state != FrameState::done) return false;
        if (job_.png && !std::filesystem::exists(path.replace_extension(".png"))) return false;
        ++skipped_;
        return true;
    }

    void summarize() const {
        std::printf("%s: %zu frame%s", entry_.name, rendered_, rendered_ == 1 ? "" : "s");
        if (job_.resume) std::printf(" (%zu more were done)", skipped_);
        std::printf(", %d samples, %.1f M shadow rays in %.2f s",
                    job_.targetError > 0 ? stats_.samples : job_.render.samples,
                    static_cast<double>(stats_.shadowRays) * 1e-6, stats_.seconds);
        if (error_) std::printf(", relMSE %.3g", error_->mean);
        std::printf(" -> %s\n", job_.output.c_str());
        if (cache_) printMemoryUse(cache_->memoryUse());
    }

    const RenderJob& job_;
    const EstimatorEntry& entry_;
    LightPlan plan_;
    LightSource light_;
    TriangleMesh mesh_;
    std::optional<MovingSet> moving_;
    std::unique_ptr<ShadowCache> cache_;
    std::optional<Scene> scene_;
    std::unique_ptr<EstimatorContext> context_;
    std::unique_ptr<Estimator> estimator_;
    std::optional<Image> reference_;
    std::optional<RelativeError> error_;
    RenderOptions options_;
    RenderStats stats_;
    Timing timing_;
    std::size_t rendered_ = 0, skipped_ = 0;
};

}  // namespace

void run(const RenderJob& job) {
    Shot(job).run();
}

void listSet(const RenderJob& job) {
    for (const auto& file : job.files) {
        if (!isGltf(file)) throwFileError(file, "no glTF file, of which alone there is a list");
        std::fputs(describe(GltfShot(file, job.mesh, job.fps)).c_str(), stdout);
    }
}

}  // namespace shadowcache
