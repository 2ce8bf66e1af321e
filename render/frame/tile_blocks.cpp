#include "render/frame/tile_blocks.h"

#include <algorithm>

#include "common/base/tuned.h"
#include "render/frame/tiles.h"

namespace shadowcache {

namespace {

/// Camera rays of a block in a pass, about. The vertices of a block should fit the processor's
/// caches, and fill clusters of near ones.
SHADOWCACHE_TUNED(std::size_t, kBlockRays, 131072);

std::size_t tilesOfBlock(const RenderOptions& options, std::size_t tiles) {
    if (options.bounces == 0) return 1;
    const std::size_t pixels =
        static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height) / tiles;
    const auto rays = static_cast<std::size_t>(std::min(options.cameraRays, options.passRays));
    return std::max<std::size_t>(1, kBlockRays / std::max<std::size_t>(1, pixels * rays));
}

}  // namespace

BounceOptions bounceOptionsOf(const FrameRequest& frame) {
    const RenderOptions& options = frame.options;
    return {options.bounces,
            options.clampIndirect,
            options.plain,
            options.sharedBounces,
            std::min(options.cameraRays, options.passRays),
            frame.plan.bounceTrust};
}

std::vector<TileBlock> blocksOf(const FrameRequest& frame, std::span<const std::size_t> tiles,
                                BlockExtent extent) {
    const std::size_t all = Tiles(frame.options).count();
    const std::size_t size = tilesOfBlock(frame.options, all);
    std::vector<TileBlock> blocks;
    for (std::size_t i = 0; i < tiles.size();) {
        TileBlock& block = blocks.emplace_back();
        if (extent == BlockExtent::given) {
            for (; block.size() < size && i < tiles.size(); ++i) block.push_back({tiles[i], i});
            continue;
        }
        const std::size_t first = tiles[i] / size * size;
        for (std::size_t tile = first; tile < std::min(first + size, all); ++tile) {
            const bool wanted = i < tiles.size() && tiles[i] == tile;
            block.push_back({tile, wanted ? std::optional(i) : std::nullopt});
            i += wanted ? 1 : 0;
        }
    }
    return blocks;
}

}  // namespace shadowcache
