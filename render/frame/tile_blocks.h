#pragma once

#include <optional>
#include <utility>

#include "render/bounces/bounce_light.h"
#include "render/frame/block_progress.h"
#include "render/frame/tile_loop.h"

namespace shadowcache {

/// The options of what bounces in a frame.
BounceOptions bounceOptionsOf(const RenderOptions& options);

/// Which tiles make a picture's bits where light bounces.
enum class BlockExtent {
    wholeFrame,  ///< as in the whole frame: tiles that are not asked for are rendered, too
    given        ///< those asked for alone: noise of their own, at less cost
};

/// Tiles of a frame that are rendered together: one at a time, or runs of them if light bounces,
/// since paths from all of their camera rays go on together. A run holds about a million camera
/// rays of a pass, so that memory does not grow with the frame.
class TileBlocks {
public:
    /// @param tiles  of the frame, ascending
    TileBlocks(const FrameRequest& frame, std::span<const std::size_t> tiles, BlockExtent extent);

    /// A tile, and its place in the list that was given; none: it is rendered for the others' sake.
    struct Tile {
        std::size_t tile;
        std::optional<std::size_t> index;
    };

    std::size_t count() const { return begins_.size() - 1; }
    std::span<const Tile> block(std::size_t i) const {
        return std::span(tiles_).subspan(begins_[i], begins_[i + 1] - begins_[i]);
    }
    /// Number of the block that holds `tile`, and the tile's in the block.
    std::pair<std::size_t, std::size_t> find(std::size_t tile) const;

private:
    std::vector<Tile> tiles_;
    std::vector<std::size_t> begins_{0};
};

/// Adds camera rays to the pixels of blocks of tiles, with all of their light.
class BlockRenderer {
public:
    /// @param frame, renderer, workspaces  outlive this object
    BlockRenderer(const FrameRequest& frame, const TileRenderer& renderer, Workspaces& workspaces);

    /// Adds camera rays `first` to `first + count - 1` to the pixels of a block, as far as their
    /// tiles have so many.
    ///
    /// @param sums      of the block's tiles
    /// @param progress  of the block
    void addCameraRays(std::span<const TileBlocks::Tile> block, int first, int count,
                       std::span<std::vector<PixelSum>> sums, BlockProgress& progress,
                       RenderStats& stats) const;
    /// Tells how far `passes` calls for a block are.
    static BlockProgress progressOf(std::span<const TileBlocks::Tile> block, int passes,
                                    std::function<void(std::size_t)> onTiles);

private:
    int raysOf(const TileBlocks::Tile& tile, int first, int count) const;
    /// Has light bounce to all places of the block's batches.
    void gather(std::span<std::vector<TileBatch>> batches, BlockProgress& progress,
                RenderStats& stats) const;

    const FrameRequest& frame_;
    const TileRenderer& renderer_;
    Workspaces& workspaces_;
    const BounceLight bounces_;
};

}  // namespace shadowcache
