#include "render/frame/frame_loop.h"

#include <algorithm>

namespace shadowcache {

namespace {

/// The pixels of a tile by their sums.
std::vector<Pixel> averagesOf(const TileRenderer& renderer, std::span<const PixelSum> sums,
                              RayCounts& count) {
    std::vector<Pixel> pixels;
    pixels.reserve(sums.size());
    for (const PixelSum& sum : sums) {
        pixels.push_back(renderer.average(sum));
        count.add(pixels.back());
    }
    return pixels;
}

/// Tile by tile: no light bounces from one to the next.
void renderOneByOne(const FrameRequest& frame, std::span<const std::size_t> tiles,
                    RenderStats& stats, const TileSink& sink) {
    const TileRenderer renderer(frame);
    Workspaces workspaces(frame.estimator);
    std::vector<RayCounts> counts(tiles.size());
    forEachTile(frame, tiles, workspaces, stats, [&](const TileTurn& turn) {
        std::vector<PixelSum> sums(turn.places.size());
        renderer.renderTile(turn.places, frame.raysOfTile(turn.index), turn.scratch, turn.workspace,
                            sums);
        sink.take({turn.index, turn.places, averagesOf(renderer, sums, counts[turn.index])});
        sink.taken(1);
    });
    for (const RayCounts& count : counts) count.addTo(stats);
}

/// Block by block: the paths of a block go on together.
void renderBlocks(const FrameRequest& frame, const TileBlocks& blocks, RenderStats& stats,
                  const TileSink& sink) {
    const TileRenderer renderer(frame);
    Workspaces workspaces(frame.estimator);
    const BlockRenderer block(frame, renderer, workspaces);
    const Tiles all(frame.options);
    const RenderOptions& options = frame.options;
    const int passes = (options.cameraRays + options.passRays - 1) / options.passRays;
    RayCounts counts;
    std::vector<FilmPlace> places;
    for (std::size_t b = 0; b < blocks.count(); ++b) {
        const auto tiles = blocks.block(b);
        std::vector<std::vector<PixelSum>> sums(tiles.size());
        BlockProgress progress = BlockRenderer::progressOf(tiles, passes, sink.taken);
        for (int first = 0; first < options.cameraRays; first += options.passRays)
            block.addCameraRays(tiles, first,
                                std::min(options.passRays, options.cameraRays - first), sums,
                                progress, stats);
        progress.finish();
        for (std::size_t i = 0; i < tiles.size(); ++i) {
            if (!tiles[i].index) continue;
            all.findPlaces(tiles[i].tile, places);
            sink.take({*tiles[i].index, places, averagesOf(renderer, sums[i], counts)});
        }
    }
    counts.addTo(stats);
}

}  // namespace

void renderTiles(const FrameRequest& frame, std::span<const std::size_t> tiles, BlockExtent extent,
                 RenderStats& stats, const TileSink& sink) {
    if (frame.options.bounces == 0)
        renderOneByOne(frame, tiles, stats, sink);
    else
        renderBlocks(frame, TileBlocks(frame, tiles, extent), stats, sink);
}

}  // namespace shadowcache
