#pragma once

#include "render/frame/tile_blocks.h"

namespace shadowcache {

/// A tile that is done.
struct RenderedTile {
    std::size_t index;  ///< in the list of tiles
    std::span<const FilmPlace> places;
    std::span<const Pixel> pixels;
};

/// Renders `tiles` to their end, in parallel; `take` has each as it is done, in no stated order.
void renderTiles(const FrameRequest& frame, std::span<const std::size_t> tiles, BlockExtent extent,
                 RenderStats& stats, const std::function<void(const RenderedTile&)>& take);

}  // namespace shadowcache
