#pragma once

#include "render/frame/tile_blocks.h"

namespace shadowcache {

/// A tile that is done.
struct RenderedTile {
    std::size_t index;  ///< in the list of tiles
    std::span<const FilmPlace> places;
    std::span<const Pixel> pixels;
};

/// Who has the tiles of a frame as they are done, in no stated order.
struct TileSink {
    std::function<void(const RenderedTile&)> take;
    /// So many tiles more are done, or as good as: those of a block take their time together.
    std::function<void(std::size_t)> taken = [](std::size_t) {};
};

/// Renders `tiles` to their end, in parallel.
void renderTiles(const FrameRequest& frame, std::span<const std::size_t> tiles, BlockExtent extent,
                 RenderStats& stats, const TileSink& sink);

}  // namespace shadowcache
