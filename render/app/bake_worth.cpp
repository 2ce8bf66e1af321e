#include "render/app/bake_worth.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include "bake/app/bake_task.h"
#include "bake/core/baker.h"
#include "common/base/json_file.h"
#include "common/base/process.h"
#include "render/app/duration_text.h"
#include "render/app/pair_noise.h"
#include "render/app/thumbnail.h"

namespace shadowcache {

namespace {

/// Camera rays times samples of its pixels, at most.
constexpr int kMostRays = 64;

/// A bake of the shot, or of one picture of it.
struct ShotTask {
    std::optional<ShotSource> shot;
    std::optional<BakeTask> task;

    /// @param job  outlives this
    ShotTask(const BakeJob& job, Scene& scene) {
        shot.emplace(job.shot, job.files, job.mesh);
        std::optional<ShotLookups> none;
        task.emplace(job, shot, scene, none);
    }
};

/// Two pictures of a thumbnail that differ in their random numbers alone, and what one takes.
struct Thumbnails {
    PicturePair light;
    double planSeconds = 0;  ///< of the plan, whatever the picture's size
    double filmSeconds = 0;  ///< of the rays that a larger picture has more of

    Thumbnails(const WorthView& view, PictureOptions asked, const ShadowCache* cache) {
        for (auto& pixels : light) {
            const PictureSettings settings = resolve(asked, cache != nullptr);
            LitStage lit(view.scene, cache, settings.estimator, lightingOf(asked, settings));
            lit.setEnvironment(view.environment);
            RenderStats stats;
            const double start = secondsNow();
            const Picture picture = lit.plan(view.camera, view.frame, settings.options, stats);
            const double planned = secondsNow();
            const Film film = picture.film(stats);
            planSeconds += (planned - start) / 2;
            filmSeconds += (secondsNow() - planned) / 2;
            for (const Pixel& pixel : film.pixels)
                pixels.push_back(static_cast<double>(view.environment.luminance(pixel.color)));
            ++asked.options.seed;
        }
    }
};

/// The rays of a thumbnail that is asked for as the pictures are.
PixelRays raysOfThumbnail(const RenderOptions& options) {
    const int samples = std::min(options.samples, kMostRays);
    PixelRays rays;
    rays.cameraRays = std::clamp(options.cameraRays, 1, std::max(1, kMostRays / samples));
    rays.samples = samples;
    return rays;
}

}  // namespace

BakeWorth worthOfBake(const BakeJob& bake, const TriangleMesh& mesh, const WorthView& view) {
    BakeWorth worth;
    Scene scene(mesh);
    const double start = secondsNow();
    const ShotTask whole(bake, scene);
    worth.bake =
        estimateBake(scene, whole.task->options, whole.task->selection, secondsNow() - start);

    BakeJob smaller = bake;
    smaller.shot.frames = std::to_string(view.frame);
    smaller.shot.size = thumbnailSize(bake.shot.size[0], bake.shot.size[1]);
    const ShotTask small(smaller, scene);
    const BakeResult baked = shadowcache::bake(scene, small.task->options, small.task->selection);
    const auto cache = makeCache(baked.header, baked.items);

    PictureOptions asked = view.asked;
    const RenderOptions wanted = resolve(asked, true).options;
    asked.aovs.clear();
    asked.rays = raysOfThumbnail(wanted);
    asked.options.crop.reset();
    asked.options.width = smaller.shot.size[0];
    asked.options.height = smaller.shot.size[1];
    const Thumbnails with(view, asked, cache.get());
    if (asked.estimator && findEstimator(*asked.estimator).needsCache) asked.estimator.reset();
    const Thumbnails without(view, asked, nullptr);

    const FilmRectangle region = wanted.region();
    const double rays =
        static_cast<double>(region.width) * region.height * wanted.cameraRays * wanted.samples;
    const double raysOfThumbnail =
        static_cast<double>(with.light[0].size()) * *asked.rays.cameraRays * *asked.rays.samples;
    const double larger = rays / raysOfThumbnail;
    const auto [noise, noiseWithout] =
        noiseOfPairs(with.light, without.light, smaller.shot.size[0]);
    worth.frameSeconds = with.planSeconds + with.filmSeconds * larger;
    // Without noise there is nothing to save.
    worth.withoutSeconds =
        noise > 0 ? without.planSeconds + without.filmSeconds * larger * noiseWithout / noise
                  : worth.frameSeconds;
    return worth;
}

std::string textOf(const BakeWorth& worth, int frames) {
    std::string text = fmt::format(
        "bake        {}, {:.3g} MB, by a sample; spacing {:.3g} m, level {}\n"
        "frame       {} with the cache, {} without one for the same noise, by a thumbnail\n",
        durationText(worth.bake.seconds), static_cast<double>(worth.bake.bytes) * 1e-6,
        worth.bake.spacing, worth.bake.level, durationText(worth.frameSeconds),
        durationText(worth.withoutSeconds));
    const double saved = worth.savedSeconds();
    if (!(saved > 0)) return text + "worth       no bake: a frame takes no less with one\n";
    const double first = std::ceil(worth.bake.seconds / saved);
    if (first > frames)
        return text +
               fmt::format("worth       no bake for {} frame{}: one pays from frame {:.0f} on\n",
                           frames, frames == 1 ? "" : "s", first);
    return text + fmt::format("worth       a bake: it pays from frame {:.0f} on and saves {}\n",
                              std::max(1.0, first),
                              durationText(frames * saved - worth.bake.seconds));
}

void writeWorth(const BakeWorth& worth, const std::filesystem::path& path) {
    JsonFile out;
    out.set("worth.seconds.bake", worth.bake.seconds);
    out.set("worth.seconds.frame", worth.frameSeconds);
    out.set("worth.seconds.frame_without", worth.withoutSeconds);
    out.write(path);
}

}  // namespace shadowcache
