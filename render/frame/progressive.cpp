// Passes until the observer ends them; --time-limit is such an observer: filmOf() in
// render/app/run_job.cpp.

#include "render/frame/progressive.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "common/base/progress.h"
#include "render/frame/film_parts.h"
#include "render/frame/frame_loop.h"
#include "render/frame/preview.h"

namespace shadowcache {

namespace {

/// Leaves a pass that is not complete.
struct PassStopped {};

}  // namespace

ProgressiveFrame renderProgressive(const FrameRequest& wanted, RenderStats& stats,
                                   const ProgressiveObserver& observer) {
    const FrameRequest frame = withPreviewMargin(wanted);
    const RenderOptions& options = frame.options;
    const std::vector<std::size_t> tiles = Tiles(options).touching(options.region());
    FrameLoop loop(frame, blocksOf(frame, tiles, BlockExtent::wholeFrame));
    ProgressiveFrame result;
    RayCounts counts;
    const auto renderPass = [&](RayRange pass) {
        Film film = makeFilm(options, frame.estimator.context().groups);
        Progress progress(fmt::format("frame {}, camera rays {} to {}", frame.number,
                                      pass.first + 1, pass.first + pass.count),
                          tiles.size());
        counts = loop.run(pass, stats,
                          {.onTile = [&](const RenderedTile& t) { placePixels(t, film); },
                           .onProgress = [&](std::size_t count) { progress.add(count); },
                           .onBlock =
                               [&] {
                                   if (pass.first > 0 && observer.stop()) throw PassStopped();
                               }});
        requireFinite(film, frame.number, options.seed);
        return finishFilm(wanted, std::move(film), stats);
    };
    try {
        while (result.cameraRays < options.cameraRays) {
            const int count = std::min(options.passRays, options.cameraRays - result.cameraRays);
            result.film = renderPass({result.cameraRays, count});
            result.cameraRays += count;
            if (result.cameraRays < options.cameraRays)
                observer.onPass(result.film, result.cameraRays);
        }
    } catch (const PassStopped&) {
        result.end = FrameEnd::stopped;
    } catch (const Interrupted&) {
        if (result.cameraRays == 0) throw;
        result.end = FrameEnd::interrupted;
    }
    counts.addTo(stats);
    return result;
}

}  // namespace shadowcache
