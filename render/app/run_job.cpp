#include "render/app/run_job.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <memory>

#include "common/base/error.h"
#include "common/base/option_checks.h"
#include "common/base/parallel.h"
#include "common/base/percent_text.h"
#include "common/base/process.h"
#include "common/base/progress.h"
#include "common/image/exr.h"
#include "common/import/load_mesh.h"
#include "common/import/mesh_reader.h"
#include "common/shot/camera_source.h"
#include "common/shot/gltf_shot.h"
#include "common/shot/picture_view.h"
#include "render/app/explain.h"
#include "render/app/frame_check.h"
#include "render/app/frame_metadata.h"
#include "render/app/job_cache.h"
#include "render/app/job_output.h"
#include "render/app/memory_report.h"
#include "render/app/pixel_report.h"
#include "render/frame/aov_channels.h"
#include "render/frame/integrator.h"
#include "render/frame/pilot.h"
#include "render/frame/progressive.h"
#include "render/frame/target_error.h"
#include "render/library/pixel_rays.h"
#include "render/library/shot.h"
#include "render/library/stale_cache.h"
#include "render/shot/environment_loader.h"
#include "render/shot/light_plan.h"

namespace shadowcache {

namespace {

/// Share of the camera rays without cache items up to which the last line does not mention them:
/// the bake of a shot leaves no more.
constexpr double kFewWithoutItems = 1e-3;

/// Refuses invalid options before the long work starts.
///
/// @return the estimator asked for
const EstimatorEntry& validate(const RenderJob& job) {
    validate(job.render);
    requireRange("threads", job.threads, 0, kMaxThreads);
    requireRange("fps", job.fps, 1e-3, 1e6);
    requireRange("time-limit", job.timeLimit, 0.0, 1e9);
    requireRange("exposure", job.exposure, -64.0f, 64.0f);
    requireRange("fov-y", job.camera.fovYDegrees, 0.01, 179.0);
    if (job.debugPixel) {
        requireRange("debug (x)", (*job.debugPixel)[0], 0, job.render.width - 1);
        requireRange("debug (y)", (*job.debugPixel)[1], 0, job.render.height - 1);
    }
    const EstimatorEntry& entry = estimatorOf(job);
    requireFit(entry, !job.cache.empty(), job.render);
    validateOutputs(job, entry);
    return entry;
}

/// What reading a map has to say.
void printNote(const std::string& text, NoteKind kind) {
    if (kind == NoteKind::warning)
        std::fprintf(stderr, "shadowcache-render: warning: %s\n", text.c_str());
    else
        std::printf("map: %s\n", text.c_str());
}

/// A job in progress: the inputs, loaded once, and the frames.
class Run {
public:
    explicit Run(const RenderJob& job)
        : job_(job),
          entry_(validate(job)),
          plan_(job.light, job.frames, job.shotFrames),
          light_(printNote),
          inputs_(job.mesh.references) {
        setThreadCount(job.threads);
        installInterruptHandler();
    }

    void run() {
        const double start = secondsNow();
        plan_.requireFiles();
        if (job_.check) return checkFrames(job_, plan_, inputs_);
        refuseToOverwriteInputs(job_, plan_);
        if (nothingLeft()) {
            skipped_ = job_.frames.size();
            return summarize();
        }
        if (!job_.explain && !job_.debugPixel) requireWritableOutputs(job_);
        std::vector<GltfShot> shots = openShots(job_.files, job_.mesh, job_.fps);
        const CameraSource camera(job_.camera, shots);
        for (const int frame : job_.frames) camera.moveAt(frame);
        if (!job_.reference.empty()) reference_ = readReference(job_.reference, job_.render);
        mesh_ = loadMesh(job_.files, job_.mesh);
        std::printf("set: %s\n", describe(mesh_.report).c_str());
        moving_.emplace(shots, job_.dynamic, job_.mesh, mesh_.origin, job_.fps);
        for (const int frame : job_.frames) moving_->requireFrame(frame);
        for (GltfShot& shot : shots) shot.dropData();
        if (!moving_->empty())
            std::printf("moving: %zu triangles, not in the cache\n", moving_->triangles());
        cache_ = openCacheOfSet(job_, mesh_);
        const double loaded = secondsNow();
        scene_.emplace(mesh_);
        makeShot();
        timing_ = {loaded - start, secondsNow() - loaded};
        options_ = job_.render;
        options_.insight = std::ranges::any_of(job_.aovs, needsInsight);
        Progress progress("frames", job_.frames.size());
        for (std::size_t i = 0; i < job_.frames.size(); ++i) {
            frame(camera, i);
            progress.add(1);
            if (job_.explain) return;
            if (interrupted_) break;
        }
        if (job_.debugPixel) return;
        summarize();
        if (!job_.stats.empty())
            writeStats(job_, entry_, mesh_, cache_.get(), timing_, stats_, error_);
        // The frame is there, but is not what was asked for: --resume renders it again.
        if (interrupted_) throw Interrupted();
    }

private:
    void frame(const CameraSource& camera, std::size_t i) {
        throwIfInterrupted();
        const int frame = job_.frames[i];
        Metadata metadata =
            frameMetadata(job_, cache_ ? std::optional(cache_->header().fingerprint) : std::nullopt,
                          plan_.at(i), frame, inputs_);
        if (job_.resume && !job_.explain && isDone(metadata, frame)) return;
        const double start = secondsNow();
        if (light_.load(plan_.at(i))) shot_->setEnvironment(light_.environment());
        const Estimator& estimator = shot_->estimator();
        timing_.build += secondsNow() - start;
        scene_->setMoving(moving_->pose(frame));
        const double before = stats_.seconds;
        const FrameRequest wanted{estimator, camera.moveAt(frame), frame, options_};
        view_ = viewOf(wanted.camera.middle(), options_.width, options_.height);
        view_.framesPerSecond = camera.fps() > 0 ? camera.fps() : job_.fps;
        view_.chromaticities = light_.chromaticities();
        if (job_.explain) {
            const Forecast forecast{entry_, !job_.estimator.empty(),
                                    static_cast<int>(job_.frames.size()),
                                    timing_.load + timing_.build};
            std::fputs(explain(wanted, forecast).c_str(), stdout);
            return;
        }
        const auto [request, correction] = planned(wanted);
        if (job_.debugPixel) {
            const auto [x, y] = *job_.debugPixel;
            reportPixel(request, x, y);
            return;
        }
        const ProgressiveFrame done = renderFrame(request, metadata, before);
        const Film& film = done.film;
        stats_.samples = request.options.samples;
        stats_.cameraRaysAPixel = meanCameraRays(film);
        stats_.ownError =
            correction *
            measuredError(film.pixels, estimator.context().environment.luminanceWeights());
        if (job_.targetError > 0) reportError(frame);
        writeFrame(job_, film, std::move(metadata), view_,
                   {stats_.seconds - before, done.cameraRays, done.end != FrameEnd::interrupted},
                   frame);
        ++rendered_;
        if (reference_) error_ = relativeError(colorImage(film), *reference_);
        if (done.end != FrameEnd::complete)
            std::printf("frame %d: %s after %d of %d camera rays a pixel\n", frame,
                        done.end == FrameEnd::interrupted ? "interrupted" : "out of time",
                        done.cameraRays, request.options.cameraRays);
        interrupted_ = done.end == FrameEnd::interrupted;
    }

    TargetPlan planned(const FrameRequest& wanted) {
        if (job_.targetError > 0) return planForError(wanted, job_.targetError, stats_);
        TargetPlan plain{wanted};
        plain.frame.plan = planFrame(wanted, stats_);
        return plain;
    }

    void makeShot() {
        shot_.emplace(*scene_, cache_.get(), entry_,
                      ShotOptions{job_.estimatorOptions, job_.sequence, job_.render.bounces,
                                  job_.render.plain});
        if (!shot_->missesTransport()) return;
        requireTransport(*shot_, job_.render, job_.cache);
        std::printf(
            "bounces: not predicted, the cache holds no transport; unbiased, but noisier\n");
    }

    /// The frame; with --progressive the file is written after each pass.
    ProgressiveFrame renderFrame(const FrameRequest& request, const Metadata& metadata,
                                 double before) {
        if (!job_.progressive)
            return {render(request, stats_), request.options.cameraRays, FrameEnd::complete};
        const double end =
            job_.timeLimit > 0 ? secondsNow() + job_.timeLimit : std::numeric_limits<double>::max();
        ProgressiveObserver observer;
        observer.stop = [end] { return secondsNow() > end; };
        observer.onPass = [&](const Film& film, int cameraRays) {
            writeFrame(job_, film, metadata, view_, {stats_.seconds - before, cameraRays, false},
                       request.number);
        };
        return renderProgressive(request, stats_, observer);
    }

    /// Prints the error estimated from the spread of the frame's camera rays.
    void reportError(int frame) const {
        std::printf(
            "frame %d: %.4g camera rays a pixel, relMSE %.3g by the spread of its camera rays, "
            "target %.3g\n",
            frame, stats_.cameraRaysAPixel, stats_.ownError, job_.targetError);
    }

    /// Whether --resume finds every frame, so that the set need not be loaded.
    bool nothingLeft() {
        return job_.resume && !job_.explain && !job_.debugPixel && job_.reference.empty() &&
               job_.stats.empty() && allFramesDone(job_, plan_, inputs_);
    }

    /// Whether the frame exists as it would be rendered; counts those that do, reports the others.
    bool isDone(const Metadata& metadata, int frame) {
        const FrameState state = stateOfFrame(job_, metadata, frame);
        const auto file = frameFile(job_, frame);
        if (state == FrameState::broken)
            std::printf("%s: incomplete, rendered again\n", file.c_str());
        if (state == FrameState::changed)
            std::printf("%s: from other settings or files, rendered again\n", file.c_str());
        if (state != FrameState::done) return false;
        ++skipped_;
        return true;
    }

    /// Camera rays asked for by samples of each; those that pixels have, where these are others.
    void printEffort() const {
        if (job_.targetError > 0) {
            std::printf(", %.4g camera rays a pixel", stats_.cameraRaysAPixel);
            return;
        }
        std::printf(", %d x %d samples", job_.render.cameraRays, stats_.samples);
        if (stats_.cameraRaysAPixel != job_.render.cameraRays)
            std::printf(" with %.4g camera rays a pixel", stats_.cameraRaysAPixel);
    }

    void summarize() const {
        std::printf("%s: %zu frame%s", entry_.name, rendered_, rendered_ == 1 ? "" : "s");
        if (job_.resume)
            std::printf(" (%zu more %s done)", skipped_, skipped_ == 1 ? "was" : "were");
        printEffort();
        std::printf(", %.1f M camera rays, %.1f M shadow rays",
                    static_cast<double>(stats_.cameraRays + stats_.spreadRays) * 1e-6,
                    static_cast<double>(stats_.shadowRays) * 1e-6);
        if (stats_.reusedRays > 0)
            std::printf(" (%.1f M of them reuse neighbours' samples)",
                        static_cast<double>(stats_.reusedRays) * 1e-6);
        if (stats_.bounces.rays() > 0)
            std::printf(", %.1f M rays of bounces",
                        static_cast<double>(stats_.bounces.rays()) * 1e-6);
        const double without = static_cast<double>(stats_.raysWithoutItems) /
                               static_cast<double>(std::max<std::uint64_t>(stats_.cameraRays, 1));
        if (without > kFewWithoutItems)
            std::printf(", %s of the camera rays found no item", percentText(without, 2).c_str());
        std::printf(" in %.2f s", stats_.seconds);
        if (job_.render.preview) std::printf(" (biased: filtered)");
        if (error_) std::printf(", relMSE %.3g", error_->mean);
        std::printf(" -> %s\n", outputName(job_).c_str());
        if (cache_) printMemoryUse(cache_->memoryUse(), shot_ ? shot_->bounceBytes() : 0);
    }

    const RenderJob& job_;
    const EstimatorEntry& entry_;
    LightPlan plan_;
    EnvironmentLoader light_;
    TriangleMesh mesh_;
    std::optional<MovingSet> moving_;
    std::unique_ptr<ShadowCache> cache_;
    std::optional<Scene> scene_;
    std::optional<Shot> shot_;
    std::optional<Image> reference_;
    std::optional<RelativeError> error_;
    RenderOptions options_;
    ExrView view_;  ///< of the frame
    RenderStats stats_;
    Timing timing_;
    InputHashes inputs_;
    std::size_t rendered_ = 0, skipped_ = 0;
    bool interrupted_ = false;  ///< a progressive frame, which was written all the same
};

}  // namespace

void run(const RenderJob& job) {
    Run(job).run();
}

void listSet(const RenderJob& job) {
    std::size_t cameras = 0;
    for (const auto& file : job.files) {
        if (!isGltf(file)) throwFileError(file, "--list supports glTF only");
        const GltfShot shot(file, job.mesh, job.fps);
        std::fputs(describe(shot, cameras).c_str(), stdout);
        cameras += shot.cameraNodes().size();
    }
}

}  // namespace shadowcache
