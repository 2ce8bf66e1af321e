#include "render/frame/integrator.h"

#include <algorithm>
#include <string>
#include <utility>

#include "common/base/error.h"
#include "common/base/progress.h"
#include "render/frame/film_parts.h"
#include "render/frame/preview.h"
#include "render/frame/tile_loop.h"

namespace shadowcache {

Film render(const FrameRequest& wanted, RenderStats& stats) {
    const FrameRequest frame = withPreviewMargin(wanted);
    const RenderOptions& options = frame.options;
    Film film = makeFilm(options);
    const std::vector<std::size_t> tiles = Tiles(options).touching(options.region());
    Progress progress("frame " + std::to_string(frame.number), tiles.size());
    renderTiles(frame, tiles, stats, [&](const TileTurn& turn, std::span<const Pixel> pixels) {
        placePixels(turn.places, pixels, film);
        progress.add(1);
    });
    requireFinite(film, frame.number, options.seed);
    return finishFilm(wanted, std::move(film), stats);
}

std::vector<std::vector<Pixel>> renderSomeTiles(const FrameRequest& frame,
                                                std::span<const std::size_t> numbers,
                                                RenderStats& stats) {
    const std::vector<std::size_t> all = Tiles(frame.options).touching(frame.options.region());
    FrameRequest some = frame;
    some.tileRays.clear();
    std::vector<std::size_t> tiles;
    for (const std::size_t number : numbers) {
        tiles.push_back(all[number]);
        some.tileRays.push_back(frame.raysOfTile(number));
    }
    std::vector<std::vector<Pixel>> parts(tiles.size());
    renderTiles(some, tiles, stats, [&](const TileTurn& turn, std::span<const Pixel> pixels) {
        parts[turn.index].assign(pixels.begin(), pixels.end());
    });
    return parts;
}

namespace {

/// Camera rays of a tile of the frame.
int raysOf(const FrameRequest& frame, std::size_t tile) {
    if (frame.tileRays.empty()) return frame.options.cameraRays;
    const auto tiles = Tiles(frame.options).touching(frame.options.region());
    const auto found = std::ranges::find(tiles, tile);
    return found == tiles.end() ? frame.options.cameraRays
                                : frame.raysOfTile(static_cast<std::size_t>(found - tiles.begin()));
}

}  // namespace

Pixel renderPixel(const FrameRequest& frame, int x, int y, const CameraSampleObserver& observer) {
    TileRenderer renderer(frame);
    renderer.observe(x, y, observer);
    const auto workspace = frame.estimator.makeWorkspace();
    TileScratch scratch;
    std::vector<FilmPlace> places;
    const Tiles tiles(frame.options);
    const std::size_t tile = tiles.tileOf(x, y);
    tiles.findPlaces(tile, places);
    const int cameraRays = raysOf(frame, tile);
    std::vector<PixelSum> sums(places.size());
    renderer.renderTile(places, cameraRays, scratch, *workspace, sums);
    const auto place =
        std::ranges::find_if(places, [&](const FilmPlace& p) { return p.x == x && p.y == y; });
    return renderer.average(sums[static_cast<std::size_t>(place - places.begin())]);
}

}  // namespace shadowcache
