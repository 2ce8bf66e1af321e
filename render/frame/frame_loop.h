#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "render/frame/block_renderer.h"

namespace shadowcache {

/// A tile that has all camera rays of a run.
struct RenderedTile {
    std::size_t index;  ///< in the list of tiles
    std::span<const FilmPlace> places;
    std::span<const Pixel> pixels;
    const GroupedLight& groups;  ///< of the pixels; empty without groups
};

/// Watches the loop, from several threads.
struct LoopObserver {
    /// Receives the tiles as they are done, in no stated order.
    std::function<void(const RenderedTile&)> onTile;
    /// So many tiles more are done, or as good as: those of a block take their time together.
    std::function<void(std::size_t)> onProgress = [](std::size_t) {};
    /// Called before each block; may end the run by what it throws.
    std::function<void()> onBlock = [] {};
};

/// Rays that pixels took.
struct RayCounts {
    std::uint64_t camera = 0, shadow = 0, reused = 0;

    void add(const Pixel& pixel);
    void add(const RayCounts& other);
    void addTo(RenderStats& stats) const;
};

/// The loop over the blocks of a frame, in parallel; if light bounces, each in parallel as well.
class FrameLoop {
public:
    /// @param frame   outlives this object
    /// @param blocks  by blocksOf()
    FrameLoop(const FrameRequest& frame, std::vector<TileBlock> blocks,
              std::optional<WatchedPixel> watched = {});

    /// Adds camera rays to all pixels, in passes. Runs follow one another, from the first camera
    /// ray to the last of the frame's options; after the last, nothing is kept.
    ///
    /// @param stats  gets times, and rays of bounces
    /// @return rays that the pixels have taken since the first run
    /// @throws what onBlock throws, Interrupted; no run may follow
    RayCounts run(RayRange rays, RenderStats& stats, const LoopObserver& observer);

private:
    /// Adds camera rays to a block's pixels.
    void render(std::size_t block, RayRange rays, BounceCounts& bounces,
                const LoopObserver& observer);
    /// Hands on the tiles that were asked for.
    RayCounts finish(std::size_t block, const LoopObserver& observer) const;

    const FrameRequest& frame_;
    const std::vector<TileBlock> blocks_;
    BlockRenderer renderer_;
    std::vector<std::vector<TilePixels>> pixels_;  ///< by block and tile
};

/// Renders tiles of a frame to their end.
void renderTiles(const FrameRequest& frame, std::span<const std::size_t> tiles, BlockExtent extent,
                 RenderStats& stats, const LoopObserver& observer);

}  // namespace shadowcache
