#include "render/frame/progressive.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>

#include "common/base/progress.h"
#include "render/frame/film_parts.h"
#include "render/frame/preview.h"
#include "render/frame/tile_blocks.h"

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
          blocks_(frame, tiles_, BlockExtent::wholeFrame),
          blockRenderer_(frame, renderer_, workspaces_),
          sums_(tiles_.size()),
          blockSums_(blocks_.count()) {}

    /// Adds `count` camera rays to each pixel.
    ///
    /// @throws PassStopped, Interrupted; the sums are then of no use
    Film run(int first, int count, const std::function<bool()>& stop, RenderStats& stats) {
        Film film = makeFilm(frame_.options);
        counts_.assign(tiles_.size(), {});
        Progress progress(
            fmt::format("frame {}, camera rays {} to {}", frame_.number, first + 1, first + count),
            tiles_.size());
        const auto finish = [&](std::size_t index, std::span<const FilmPlace> places,
                                std::span<const PixelSum> sums) {
            place(index, places, sums, film);
        };
        const auto mayStop = [&] {
            if (first > 0 && stop()) throw PassStopped();
        };
        if (frame_.options.bounces == 0)
            addTiles(first, count, mayStop, finish, progress, stats);
        else
            addBlocks(first, count, mayStop, finish, progress, stats);
        requireFinite(film, frame_.number, frame_.options.seed);
        total_ = {};
        for (const RayCounts& ofTile : counts_) total_.add(ofTile);
        return film;
    }

    /// Of all complete passes.
    const RayCounts& total() const { return total_; }

private:
    template <class MayStop, class Finish>
    void addTiles(int first, int count, const MayStop& mayStop, const Finish& finish,
                  Progress& progress, RenderStats& stats) {
        forEachTile(frame_, tiles_, workspaces_, stats, [&](const TileTurn& turn) {
            mayStop();
            std::vector<PixelSum>& sums = sums_[turn.index];
            sums.resize(turn.places.size());
            const int rays = std::min(count, frame_.raysOfTile(turn.index) - first);
            if (rays > 0)
                renderer_.addCameraRays(turn.places, first, rays, turn.scratch, turn.workspace,
                                        sums);
            finish(turn.index, turn.places, sums);
            progress.add(1);
        });
    }

    template <class MayStop, class Finish>
    void addBlocks(int first, int count, const MayStop& mayStop, const Finish& finish,
                   Progress& progress, RenderStats& stats) {
        const Tiles all(frame_.options);
        std::vector<FilmPlace> places;
        for (std::size_t b = 0; b < blocks_.count(); ++b) {
            mayStop();
            const auto tiles = blocks_.block(b);
            std::vector<std::vector<PixelSum>>& sums = blockSums_[b];
            sums.resize(tiles.size());
            BlockProgress ofBlock =
                BlockRenderer::progressOf(tiles, 1, [&](std::size_t more) { progress.add(more); });
            blockRenderer_.addCameraRays(tiles, first, count, sums, ofBlock, stats);
            ofBlock.finish();
            for (std::size_t i = 0; i < tiles.size(); ++i) {
                if (!tiles[i].index) continue;
                all.findPlaces(tiles[i].tile, places);
                finish(*tiles[i].index, places, sums[i]);
            }
        }
    }

    void place(std::size_t index, std::span<const FilmPlace> places, std::span<const PixelSum> sums,
               Film& film) {
        std::vector<Pixel> pixels;
        pixels.reserve(sums.size());
        for (const PixelSum& sum : sums) {
            pixels.push_back(renderer_.average(sum));
            counts_[index].add(pixels.back());
        }
        placePixels(places, pixels, film);
    }

    const FrameRequest& frame_;
    const TileRenderer renderer_;
    Workspaces workspaces_;
    const std::vector<std::size_t> tiles_;
    const TileBlocks blocks_;
    const BlockRenderer blockRenderer_;
    std::vector<std::vector<PixelSum>> sums_;                    ///< by tile
    std::vector<std::vector<std::vector<PixelSum>>> blockSums_;  ///< by block and tile of it
    std::vector<RayCounts> counts_;
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
