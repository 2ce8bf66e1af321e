#include "render/frame/tile_blocks.h"

#include <algorithm>

#include "render/frame/time_keeper.h"

namespace shadowcache {

namespace {

/// Camera rays of a block in a pass, about: what bounces takes some hundred bytes for each.
constexpr std::size_t kBlockRays = std::size_t{1} << 20;

std::size_t tilesOfBlock(const FrameRequest& frame, const Tiles& all) {
    const RenderOptions& options = frame.options;
    if (options.bounces == 0) return 1;
    const std::size_t pixels = static_cast<std::size_t>(options.width) *
                               static_cast<std::size_t>(options.height) / all.count();
    const auto rays = static_cast<std::size_t>(std::min(options.cameraRays, options.passRays));
    return std::max<std::size_t>(1, kBlockRays / std::max<std::size_t>(1, pixels * rays));
}

}  // namespace

BounceOptions bounceOptionsOf(const RenderOptions& options) {
    return {options.bounces, options.clampIndirect, options.plain, options.sharedBounces,
            std::min(options.cameraRays, options.passRays)};
}

TileBlocks::TileBlocks(const FrameRequest& frame, std::span<const std::size_t> tiles,
                       BlockExtent extent) {
    const Tiles all(frame.options);
    const std::size_t size = tilesOfBlock(frame, all);
    for (std::size_t i = 0; i < tiles.size();) {
        if (extent == BlockExtent::wholeFrame) {
            const std::size_t block = tiles[i] / size;
            for (std::size_t tile = block * size; tile < std::min((block + 1) * size, all.count());
                 ++tile) {
                const bool wanted = i < tiles.size() && tiles[i] == tile;
                tiles_.push_back({tile, wanted ? std::optional(i) : std::nullopt});
                i += wanted ? 1 : 0;
            }
        } else {
            for (std::size_t k = 0; k < size && i < tiles.size(); ++k, ++i)
                tiles_.push_back({tiles[i], i});
        }
        begins_.push_back(tiles_.size());
    }
}

std::pair<std::size_t, std::size_t> TileBlocks::find(std::size_t tile) const {
    std::size_t i = 0, block = 0;
    while (tiles_[i].tile != tile) ++i;
    while (begins_[block + 1] <= i) ++block;
    return {block, i - begins_[block]};
}

BlockRenderer::BlockRenderer(const FrameRequest& frame, const TileRenderer& renderer,
                             Workspaces& workspaces)
    : frame_(frame),
      renderer_(renderer),
      workspaces_(workspaces),
      bounces_(frame.estimator, frame.plan.estimator.get(), bounceOptionsOf(frame.options)) {}

BlockProgress BlockRenderer::progressOf(std::span<const TileBlocks::Tile> block, int passes,
                                        std::function<void(std::size_t)> onTiles) {
    const auto wanted =
        std::ranges::count_if(block, [](const auto& tile) { return tile.index.has_value(); });
    // Direct light and what bounces take about the same time.
    const std::size_t work = 2 * block.size() * static_cast<std::size_t>(passes);
    return {static_cast<std::size_t>(wanted), work, std::move(onTiles)};
}

int BlockRenderer::raysOf(const TileBlocks::Tile& tile, int first, int count) const {
    // What is planned tile by tile leaves out those that are not asked for.
    int rays = frame_.tileRays.empty() ? frame_.options.cameraRays : 0;
    if (tile.index) rays = frame_.raysOfTile(*tile.index);
    return std::clamp(rays - first, 0, count);
}

void BlockRenderer::addCameraRays(std::span<const TileBlocks::Tile> block, int first, int count,
                                  std::span<std::vector<PixelSum>> sums, BlockProgress& progress,
                                  RenderStats& stats) const {
    std::vector<std::size_t> tiles;
    for (const TileBlocks::Tile& tile : block) tiles.push_back(tile.tile);
    std::vector<std::vector<TileBatch>> batches(tiles.size());
    forEachTile(frame_, tiles, workspaces_, stats, [&](const TileTurn& turn) {
        sums[turn.index].resize(turn.places.size());
        const int rays = raysOf(block[turn.index], first, count);
        using Lighting = TileRenderer::Lighting;
        const Lighting lighting = block[turn.index].index ? Lighting::direct : Lighting::none;
        if (rays > 0)
            renderer_.lightCameraRays(turn.places, first, rays, lighting, turn.scratch,
                                      turn.workspace, sums[turn.index], batches[turn.index]);
        progress.add(1);
    });
    gather(batches, progress, stats);
    forEachTile(frame_, tiles, workspaces_, stats, [&](const TileTurn& turn) {
        if (block[turn.index].index)
            renderer_.addBatches(batches[turn.index], turn.workspace, sums[turn.index]);
    });
}

void BlockRenderer::gather(std::span<std::vector<TileBatch>> batches, BlockProgress& progress,
                           RenderStats& stats) const {
    if (frame_.options.bounces == 0) return;
    const TimeKeeper time(stats);
    std::vector<BounceReceiver> receivers;
    for (const std::vector<TileBatch>& tile : batches)
        for (const TileBatch& batch : tile) renderer_.findReceivers(batch.scratch, receivers);
    std::vector<BouncedLight> light(receivers.size());
    const RenderOptions& options = frame_.options;
    if (options.preview || options.samples == 0) bounces_.predict(receivers, light);
    if (options.samples == 0) {
        for (BouncedLight& l : light) l.irradiance = l.predicted;
    } else {
        BounceCounts counts;
        // Fewer paths go on from each level to the next: it is taken for half of what is left.
        std::size_t left = batches.size();
        bounces_.gather(receivers, light, counts, [&] {
            progress.add(left / 2);
            left -= left / 2;
        });
        progress.add(left);
        stats.bounces.add(counts);
    }
    auto next = light.begin();
    for (std::vector<TileBatch>& tile : batches)
        for (TileBatch& batch : tile) {
            const auto end = next + static_cast<std::ptrdiff_t>(batch.scratch.places.size());
            batch.scratch.bounced.assign(next, end);
            next = end;
        }
}

}  // namespace shadowcache
