#include "render/frame/integrator.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <utility>

#include "common/base/error.h"
#include "common/base/progress.h"
#include "render/frame/film_parts.h"
#include "render/frame/frame_loop.h"
#include "render/frame/preview.h"

namespace shadowcache {

Film render(const FrameRequest& wanted, RenderStats& stats) {
    const FrameRequest frame = withPreviewMargin(wanted);
    const RenderOptions& options = frame.options;
    Film film = makeFilm(options);
    const std::vector<std::size_t> tiles = Tiles(options).touching(options.region());
    Progress progress(fmt::format("frame {}", frame.number), tiles.size());
    const auto place = [&](const RenderedTile& tile) {
        placePixels(tile.places, tile.pixels, film);
    };
    renderTiles(frame, tiles, BlockExtent::wholeFrame, stats,
                {place, [&](std::size_t count) { progress.add(count); }});
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
    const auto keep = [&](const RenderedTile& tile) {
        parts[tile.index].assign(tile.pixels.begin(), tile.pixels.end());
    };
    renderTiles(some, tiles, BlockExtent::given, stats, {keep});
    return parts;
}

Pixel renderPixel(const FrameRequest& frame, int x, int y, const CameraSampleObserver& observer) {
    TileRenderer renderer(frame);
    renderer.observe(x, y, observer);
    Workspaces workspaces(frame.estimator);
    const Tiles all(frame.options);
    const RenderOptions& options = frame.options;
    const std::size_t tile = all.tileOf(x, y);
    // Without a plan for the region's tiles, a pixel beside the region will do.
    const std::vector<std::size_t> tiles =
        all.touching(frame.tileRays.empty() ? FilmRectangle{0, 0, options.width, options.height}
                                            : options.region());
    const TileBlocks blocks(frame, tiles, BlockExtent::wholeFrame);
    const auto [block, number] = blocks.find(tile);
    std::vector<std::vector<PixelSum>> sums(blocks.block(block).size());
    const BlockRenderer tool(frame, renderer, workspaces);
    RenderStats stats;
    BlockProgress untold;
    for (int first = 0; first < options.cameraRays; first += options.passRays)
        tool.addCameraRays(blocks.block(block), first,
                           std::min(options.passRays, options.cameraRays - first), sums, untold,
                           stats);
    std::vector<FilmPlace> places;
    all.findPlaces(tile, places);
    const auto place =
        std::ranges::find_if(places, [&](const FilmPlace& p) { return p.x == x && p.y == y; });
    return renderer.average(sums[number][static_cast<std::size_t>(place - places.begin())]);
}

}  // namespace shadowcache
