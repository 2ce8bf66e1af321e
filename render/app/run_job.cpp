#include "render/app/run_job.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
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
#include "common/mesh/placed_mesh.h"
#include "common/shot/gltf_shot.h"
#include "common/shot/picture_view.h"
#include "render/app/bake_of_shot.h"
#include "render/app/bake_worth.h"
#include "render/app/explain.h"
#include "render/app/first_passes.h"
#include "render/app/frame_check.h"
#include "render/app/frame_metadata.h"
#include "render/app/job_output.h"
#include "render/app/memory_report.h"
#include "render/app/pixel_report.h"
#include "render/frame/aov_channels.h"
#include "render/frame/target_error.h"
#include "render/library/lit_stage.h"
#include "render/library/stage.h"
#include "render/shot/environment_loader.h"
#include "render/shot/light_plan.h"

namespace shadowcache {

namespace {

/// Share of the camera rays without cache items up to which the last line does not mention them:
/// the bake of a shot leaves no more.
constexpr double kFewWithoutItems = 1e-3;

/// Refuses invalid options before the long work starts.
PictureSettings settingsOf(const RenderJob& job) {
    PictureSettings settings =
        resolve(job.picture, !job.stage.cache.empty(), job.stage.set.mesh.gloss);
    if (job.run.debugPixel) {
        requireRange("debug (x)", (*job.run.debugPixel)[0], 0, settings.options.width - 1);
        requireRange("debug (y)", (*job.run.debugPixel)[1], 0, settings.options.height - 1);
    }
    validateOutputs(job);
    return settings;
}

void printNote(const std::string& text, NoteKind kind) {
    if (kind == NoteKind::warning)
        std::fprintf(stderr, "shadowcache-render: warning: %s\n", text.c_str());
    else
        std::printf("%s\n", text.c_str());
}

/// What reading a map has to say.
void printMapNote(const std::string& text, NoteKind kind) {
    printNote(kind == NoteKind::note ? "map: " + text : text, kind);
}

/// A job in progress: the inputs, loaded once, and the frames.
class Run {
public:
    explicit Run(const RenderJob& job)
        : job_(job),
          run_(job.run),
          settings_(settingsOf(job)),
          plan_(job.light, run_.frames, run_.shotFrames),
          light_(printMapNote),
          inputs_(job.stage.set.mesh.references) {
        setThreadCount(run_.threads);
        installInterruptHandler();
    }

    void run() {
        const double start = secondsNow();
        plan_.requireFiles();
        if (run_.check) return checkFrames(job_, settings_, plan_, inputs_);
        refuseToOverwriteInputs(job_, plan_);
        if (nothingLeft()) {
            skipped_ = run_.frames.size();
            return summarize();
        }
        if (!run_.explain && !run_.debugPixel) requireWritableOutputs(job_);
        load(start);
        if (!lit_) return;  // --explain of a bake
        Progress progress("frames", run_.frames.size());
        for (std::size_t i = 0; i < run_.frames.size(); ++i) {
            frame(i);
            progress.add(1);
            if (run_.explain) return;
            if (interrupted_) break;
        }
        if (run_.debugPixel) return;
        summarize();
        if (!run_.stats.empty())
            writeStats(job_, settings_, stage_->mesh(), stage_->cache(), timing_, stats_, error_);
        // The frame is there, but is not what was asked for: --resume renders it again.
        if (interrupted_) throw Interrupted();
    }

private:
    /// Loads all but the light. What takes no time is refused before what does.
    void load(double start) {
        std::optional<BakeJob> bake;
        if (mustBake())
            validate(bake.emplace(bakeOfShot(job_)));
        else if (run_.bakes)
            useBaked();
        StageOptions options = job_.stage;
        if (bake) options.cache.clear();
        stage_.emplace(options, printNote);
        camera_.emplace(stage_->cameras(job_.camera));
        for (const int frame : run_.frames) camera_->moveAt(frame);
        if (!run_.reference.empty()) reference_ = readReference(run_.reference, settings_.options);
        stage_->load();
        for (const int frame : run_.frames) stage_->requireFrame(frame);
        noteCamera();
        double loaded = secondsNow() - stage_->sceneSeconds();
        if (bake) {
            const double before = secondsNow();
            if (run_.explain) return explainBake(*bake);
            bakeAndShow(*bake);
            start += secondsNow() - before;
            loaded += secondsNow() - before;
            stage_->loadCache(bake->output);
        }
        lit_.emplace(stage_->scene(), stage_->cache(), settings_.estimator,
                     lightingOf(job_.picture, settings_), job_.stage.cache.string());
        lit_->requirePrediction(settings_.options);
        requireLight(*lit_);
        if (!lit_->note().empty()) printNote(lit_->note(), NoteKind::note);
        timing_ = {loaded - start, secondsNow() - loaded};
    }

    /// Names what the picture shows otherwise than who made the camera may expect.
    void noteCamera() const {
        const std::string name = "camera " + job_.camera.name + ": ";
        const Camera first = camera_->moveAt(run_.frames.front()).middle();
        const RenderOptions& options = settings_.options;
        if (const std::string note = aspectNote(first, options.width, options.height);
            !note.empty())
            printNote(name + note, NoteKind::warning);
        if (const std::string note = camera_->note(run_.frames.front()); !note.empty())
            printNote(name + note, NoteKind::warning);
        Box3d box = placedBounds(stage_->mesh());
        if (box.isEmpty() || !std::isfinite(first.far)) return;
        box.min += stage_->mesh().origin;
        box.max += stage_->mesh().origin;
        double farthest = 0;
        for (const int frame : run_.frames)
            farthest = std::max(farthest, farthestOf(camera_->moveAt(frame).middle(), box));
        if (farthest > first.far)
            printNote(fmt::format("{}sees up to {:g} m along the view, the set reaches {:.4g} m",
                                  name, first.far, farthest),
                      NoteKind::note);
    }

    void requireLight(const LitStage& lit) const {
        if (job_.light.environment.empty() && !lit.shines())
            throw Error("--env: expected a map or a radiance, since nothing in the set shines");
    }

    /// Whether --bake has a bake to do before the frames.
    bool mustBake() const {
        std::error_code ignored;
        return run_.bakes && !std::filesystem::exists(job_.stage.cache, ignored);
    }

    /// Renders with the file of --bake that is there.
    void useBaked() const {
        requireOfShot(bakeOfShot(job_));
        const bool isAsked = run_.bakeSpacing > 0 || !run_.bakeQuality.empty();
        std::printf("%s: baked before, used as it is%s\n", job_.stage.cache.c_str(),
                    isAsked ? ", whatever its --bake-quality or --bake-spacing was" : "");
    }

    /// Prints what the bake takes and saves.
    void explainBake(const BakeJob& bake) {
        if (settings_.options.samples == 0 || settings_.options.preview)
            throw Error(
                "--preview: --explain compares pictures with a bake and without, expected an "
                "unbiased picture, of one sample or more");
        requireLight(LitStage(stage_->scene(), nullptr, findEstimator("mis"), {}));
        light_.load(plan_.at(0));
        const int frame = run_.frames.front();
        stage_->pose(frame);
        const CameraMove camera = camera_->moveAt(frame);
        std::optional<TriangleMesh> read;
        const TriangleMesh* mesh = meshForBake(job_, stage_->mesh());
        if (!mesh) mesh = &read.emplace(loadMesh(bake.files, bake.mesh));
        const BakeWorth worth = worthOfBake(
            bake, *mesh, {stage_->scene(), light_.environment(), camera, frame, job_.picture});
        std::fputs(textOf(worth, static_cast<int>(run_.frames.size())).c_str(), stdout);
        if (!run_.stats.empty()) writeWorth(worth, run_.stats);
    }

    /// Bakes, and shows pictures of the first frame meanwhile.
    void bakeAndShow(const BakeJob& bake) {
        const TriangleMesh& mesh = stage_->mesh();
        const int frame = run_.frames.front();
        requireLight(LitStage(stage_->scene(), nullptr, findEstimator("mis"), {}));
        light_.load(plan_.at(0));
        if (run_.wait || (run_.resume && hasPicture(frame)))
            return bakeShot(job_, bake, mesh, nullptr);
        stage_->pose(frame);
        const CameraMove camera = camera_->moveAt(frame);
        PartialCache partial;
        FirstPasses passes({stage_->scene(), light_.environment(), camera, frame, job_.picture,
                            settings_.options.cameraRays * std::max(1, settings_.options.samples),
                            [&](const FirstPass& pass) { showFirst(pass, camera); }},
                           partial);
        bakeShot(job_, bake, mesh, &partial);
        if (const std::string failure = passes.end(); !failure.empty())
            printNote("no first pictures: " + failure, NoteKind::warning);
    }

    /// Whether a picture is there that a first one must not take the place of.
    bool hasPicture(int frame) const {
        const FilmRectangle region = settings_.options.region();
        const FrameState state =
            frameState(frameFile(job_, frame), {}, region.width, region.height);
        return state == FrameState::done || state == FrameState::changed;
    }

    /// Writes a picture that is shown before the cache is baked. --resume renders it again.
    void showFirst(const FirstPass& pass, const CameraMove& camera) {
        RenderJob shown = job_;
        shown.stage.cache.clear();
        std::erase_if(shown.picture.aovs, needsInsight);
        const int frame = run_.frames.front();
        InputHashes inputs(job_.stage.set.mesh.references);
        writeFrame(shown, pass.film,
                   frameMetadata(shown, pass.settings, std::nullopt, plan_.at(0), frame, inputs),
                   pictureView(camera), {pass.seconds, pass.settings.options.cameraRays, false},
                   frame);
        std::printf("%s: %d camera ray%s a pixel, %zu items baked so far\n",
                    frameFile(job_, frame).c_str(), pass.settings.options.cameraRays,
                    pass.settings.options.cameraRays == 1 ? "" : "s", pass.items);
        std::fflush(stdout);
    }

    ExrView pictureView(const CameraMove& camera) const {
        ExrView view = viewOf(camera.middle(), settings_.options.width, settings_.options.height);
        view.framesPerSecond = camera_->fps() > 0 ? camera_->fps() : job_.stage.set.fps;
        view.chromaticities = light_.chromaticities();
        return view;
    }

    void frame(std::size_t i) {
        throwIfInterrupted();
        const int frame = run_.frames[i];
        const ShadowCache* cache = stage_->cache();
        Metadata metadata = frameMetadata(
            job_, settings_, cache ? std::optional(cache->header().fingerprint) : std::nullopt,
            plan_.at(i), frame, inputs_);
        if (run_.resume && !run_.explain && isDone(metadata, frame)) return;
        const bool moved = stage_->pose(frame);
        const double start = secondsNow();
        if (light_.load(plan_.at(i)) || !isLit_) lit_->setEnvironment(light_.environment());
        if (moved) lit_->moveLamps();
        isLit_ = true;
        timing_.build += secondsNow() - start;
        const CameraMove camera = camera_->moveAt(frame);
        view_ = pictureView(camera);
        if (run_.explain) {
            const Forecast forecast{settings_.estimator, job_.picture.estimator.has_value(),
                                    static_cast<int>(run_.frames.size()),
                                    timing_.load + timing_.build};
            const FrameRequest request{lit_->estimator(), camera, frame, settings_.options};
            std::fputs(explain(request, forecast).c_str(), stdout);
            return;
        }
        const double before = stats_.seconds;
        const Picture picture = lit_->plan(camera, frame, settings_.options, stats_, targetError());
        if (run_.debugPixel) {
            const auto [x, y] = *run_.debugPixel;
            return reportPixel(picture.request(), x, y);
        }
        finish(frame, picture, std::move(metadata), before);
    }

    /// Renders a frame, writes it, and keeps what is to be said of it.
    void finish(int frame, const Picture& picture, Metadata metadata, double before) {
        const ProgressiveFrame done = filmOf(picture, metadata, before);
        const Film& film = done.film;
        const RenderOptions& options = picture.request().options;
        stats_.samples = options.samples;
        stats_.cameraRaysAPixel = meanCameraRays(film);
        stats_.ownError = picture.errorCorrection() *
                          measuredError(film.pixels, light_.environment().luminanceWeights());
        if (targetError() > 0) reportError(frame);
        writeFrame(job_, film, std::move(metadata), view_,
                   {stats_.seconds - before, done.cameraRays, done.end != FrameEnd::interrupted},
                   frame);
        ++rendered_;
        if (reference_) error_ = relativeError(colorImage(film), *reference_);
        if (done.end != FrameEnd::complete)
            std::printf("frame %d: %s after %d of %d camera rays a pixel\n", frame,
                        done.end == FrameEnd::interrupted ? "interrupted" : "out of time",
                        done.cameraRays, options.cameraRays);
        interrupted_ = done.end == FrameEnd::interrupted;
    }

    /// The frame; with --progressive the file is written after each pass.
    ProgressiveFrame filmOf(const Picture& picture, const Metadata& metadata, double before) {
        if (!run_.progressive)
            return {picture.film(stats_), picture.request().options.cameraRays, FrameEnd::complete};
        const double end =
            run_.timeLimit > 0 ? secondsNow() + run_.timeLimit : std::numeric_limits<double>::max();
        ProgressiveObserver observer;
        observer.stop = [end] { return secondsNow() > end; };
        observer.onPass = [&](const Film& film, int cameraRays) {
            writeFrame(job_, film, metadata, view_, {stats_.seconds - before, cameraRays, false},
                       picture.request().number);
        };
        return picture.film(stats_, observer);
    }

    double targetError() const { return job_.picture.rays.targetError.value_or(0); }

    /// Prints the error estimated from the spread of the frame's camera rays.
    void reportError(int frame) const {
        std::printf(
            "frame %d: %.4g camera rays a pixel, relMSE %.3g by the spread of its camera rays, "
            "target %.3g\n",
            frame, stats_.cameraRaysAPixel, stats_.ownError, targetError());
    }

    /// Whether --resume finds every frame, so that the set need not be loaded.
    bool nothingLeft() {
        return run_.resume && !mustBake() && !run_.explain && !run_.debugPixel &&
               run_.reference.empty() && run_.stats.empty() &&
               allFramesDone(job_, settings_, plan_, inputs_);
    }

    /// Whether the frame exists as it would be rendered; counts those that do, reports the others.
    bool isDone(const Metadata& metadata, int frame) {
        const FrameState state = stateOfFrame(job_, settings_, metadata, frame);
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
        if (targetError() > 0) {
            std::printf(", %.4g camera rays a pixel", stats_.cameraRaysAPixel);
            return;
        }
        std::printf(", %d x %d samples", settings_.options.cameraRays, stats_.samples);
        if (stats_.cameraRaysAPixel != settings_.options.cameraRays)
            std::printf(" with %.4g camera rays a pixel", stats_.cameraRaysAPixel);
    }

    void summarize() const {
        std::printf("%s: %zu frame%s", settings_.estimator.name, rendered_,
                    rendered_ == 1 ? "" : "s");
        if (run_.resume)
            std::printf(" (%zu more %s done)", skipped_, skipped_ == 1 ? "was" : "were");
        printEffort();
        std::printf(
            ", %.1f M camera rays, %.1f M shadow rays",
            static_cast<double>(stats_.cameraRays + stats_.spreadRays + stats_.emissionRays) * 1e-6,
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
        if (settings_.options.preview) std::printf(" (biased: filtered)");
        if (error_) std::printf(", relMSE %.3g", error_->mean);
        std::printf(" -> %s\n", outputName(job_).c_str());
        if (stage_ && stage_->cache())
            printMemoryUse(stage_->cache()->memoryUse(), lit_->bounceBytes());
    }

    const RenderJob& job_;
    const RunOptions& run_;
    const PictureSettings settings_;
    LightPlan plan_;
    EnvironmentLoader light_;
    std::optional<Stage> stage_;
    std::optional<LitStage> lit_;
    std::optional<CameraSource> camera_;
    std::optional<Image> reference_;
    std::optional<RelativeError> error_;
    ExrView view_;  ///< of the frame
    RenderStats stats_;
    Timing timing_;
    InputHashes inputs_;
    std::size_t rendered_ = 0, skipped_ = 0;
    bool isLit_ = false;        ///< the stage has the light's environment
    bool interrupted_ = false;  ///< a progressive frame, which was written all the same
};

}  // namespace

void run(const RenderJob& job) {
    Run(job).run();
}

void listSet(const RenderJob& job) {
    const SetOptions& set = job.stage.set;
    std::size_t cameras = 0;
    for (const auto& file : set.files) {
        if (!isGltf(file)) throwFileError(file, "--list supports glTF only");
        const GltfShot shot(file, meshOptionsOf(set), set.fps);
        std::fputs(describe(shot, cameras).c_str(), stdout);
        cameras += shot.cameraNodes().size();
    }
    for (const DynamicObject& object : openDynamic(set.dynamic, meshOptionsOf(set), set.fps))
        if (object.shot) std::fputs(describeMovingLamps(*object.shot).c_str(), stdout);
}

}  // namespace shadowcache
