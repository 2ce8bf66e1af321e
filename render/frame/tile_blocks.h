#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "render/bounces/bounce_task.h"
#include "render/frame/frame_request.h"

namespace shadowcache {

/// The options of what bounces in a frame.
BounceOptions bounceOptionsOf(const FrameRequest& frame);

/// Which tiles make a picture's bits where light bounces.
enum class BlockExtent {
    wholeFrame,  ///< as in the whole frame: tiles that are not asked for are rendered, too
    given        ///< those asked for alone: noise of their own, at less cost
};

/// A tile of a block.
struct BlockTile {
    std::size_t tile;
    std::optional<std::size_t> index;  ///< in the list of tiles that were asked for; none: it is
                                       ///< rendered for the others' sake
};

/// Tiles of a frame that are rendered together: one at a time, or runs of them if light bounces,
/// since paths from all of their camera rays go on together. A run holds about a million camera
/// rays of a pass, so that memory does not grow with the frame.
using TileBlock = std::vector<BlockTile>;

/// Cuts tiles of a frame, which ascend, into blocks.
std::vector<TileBlock> blocksOf(const FrameRequest& frame, std::span<const std::size_t> tiles,
                                BlockExtent extent);

}  // namespace shadowcache
