#include "render/frame/progressive.h"

#include <algorithm>
#include <string>

#include "common/base/progress.h"
#include "render/frame/film_parts.h"
#include "render/frame/preview.h"
#include "render/frame/tile_loop.h"

namespace shadowcache {

namespace {

/// Leaves a pass that is not complete.
struct PassStopped {};

/// The sums of all tiles, and the passes over them.
class Passes {
public:
    explicit Passes(const FrameRequest& frame)
        : frame_(frame),
          renderer_(frame),
          workspaces_(frame.estimator),
          tiles_(Tiles(frame.options).touching(frame.options.region())),
          sums_(tiles_.size()) {}

    /// Adds `count` camera rays to each pixel.
    ///
    /// @throws PassStopped, Interrupted; the sums are then of no use
    Film run(int first, int count, const std::function<bool()>& stop, RenderStats& stats) {
        Film film = makeFilm(frame_.options);
        std::vector<RayCounts> counts(tiles_.size());
        Progress progress("frame " + std::to_string(frame_.number) + ", camera rays " +
                              std::to_string(first + 1) + " to " + std::to_string(first + count),
                          tiles_.size());
        forEachTile(frame_, tiles_, workspaces_, stats, [&](const TileTurn& turn) {
            if (first > 0 && stop()) throw PassStopped();
            std::vector<PixelSum>& sums = sums_[turn.index];
            sums.resize(turn.places.size());
            const int rays = std::min(count, frame_.raysOfTile(turn.index) - first);
            if (rays > 0)
                renderer_.addCameraRays(turn.places, first, rays, turn.scratch, turn.workspace,
                                        sums);
            std::vector<Pixel> pixels;
            pixels.reserve(sums.size());
            for (const PixelSum& sum : sums) {
                pixels.push_back(renderer_.average(sum));
                counts[turn.index].add(pixels.back());
            }
            placePixels(turn.places, pixels, film);
            progress.add(1);
        });
        requireFinite(film, frame_.number, frame_.options.seed);
        total_ = {};
        for (const RayCounts& count_ : counts) total_.add(count_);
        return film;
    }

    /// Of all complete passes.
    const RayCounts& total() const { return total_; }

private:
    const FrameRequest& frame_;
    const TileRenderer renderer_;
    Workspaces workspaces_;
    const std::vector<std::size_t> tiles_;
    std::vector<std::vector<PixelSum>> sums_;
    RayCounts total_;
};

}  // namespace

ProgressiveFrame renderProgressive(const FrameRequest& wanted, RenderStats& stats,
                                   const ProgressiveObserver& observer) {
    const FrameRequest frame = withPreviewMargin(wanted);
    const RenderOptions& options = frame.options;
    Passes passes(frame);
    ProgressiveFrame result;
    try {
        while (result.cameraRays < options.cameraRays) {
            const int count = std::min(options.passRays, options.cameraRays - result.cameraRays);
            result.film = finishFilm(
                wanted, passes.run(result.cameraRays, count, observer.stop, stats), stats);
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
    passes.total().addTo(stats);
    return result;
}

}  // namespace shadowcache
