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
    Film film = makeFilm(options, frame.estimator.context().groups);
    const std::vector<std::size_t> tiles = Tiles(options).touching(options.region());
    Progress progress(fmt::format("frame {}", frame.number), tiles.size());
    renderTiles(frame, tiles, BlockExtent::wholeFrame, stats,
                {.onTile = [&](const RenderedTile& t) { placePixels(t, film); },
                 .onProgress = [&](std::size_t count) { progress.add(count); }});
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
    renderTiles(some, tiles, BlockExtent::given, stats, {.onTile = [&](const RenderedTile& tile) {
                    parts[tile.index].assign(tile.pixels.begin(), tile.pixels.end());
                }});
    return parts;
}

Pixel renderPixel(const FrameRequest& frame, int x, int y, const CameraSampleObserver& observer) {
    const RenderOptions& options = frame.options;
    const Tiles all(options);
    // Without camera rays of each tile of the region, a pixel beside the region will do.
    const std::vector<std::size_t> tiles =
        all.touching(frame.tileRays.empty() ? FilmRectangle{0, 0, options.width, options.height}
                                            : options.region());
    std::vector<TileBlock> blocks = blocksOf(frame, tiles, BlockExtent::wholeFrame);
    const std::size_t wanted = all.tileOf(x, y);
    std::erase_if(blocks, [&](const TileBlock& block) {
        return std::ranges::find(block, wanted, &BlockTile::tile) == block.end();
    });
    Pixel pixel;
    const auto find = [&](const RenderedTile& tile) {
        const auto place = std::ranges::find(tile.places, FilmPlace{x, y});
        if (place != tile.places.end())
            pixel = tile.pixels[static_cast<std::size_t>(place - tile.places.begin())];
    };
    RenderStats stats;
    FrameLoop(frame, std::move(blocks), WatchedPixel{{x, y}, observer})
        .run({0, options.cameraRays}, stats, {.onTile = find});
    return pixel;
}

}  // namespace shadowcache
