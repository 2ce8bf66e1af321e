#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "render/bounces/bounce_light.h"
#include "render/frame/block_progress.h"
#include "render/frame/film_rays.h"
#include "render/frame/film_sum.h"
#include "render/frame/tile_blocks.h"
#include "render/frame/tile_tools.h"

namespace shadowcache {

/// The pixels of a tile so far.
struct TilePixels {
    std::vector<FilmPlace> places;
    std::vector<AdaptiveRate> rates;
    std::vector<PixelSum> sums;
    GroupedLight groups{};     ///< sums of the camera rays' colours by light group
    GroupedLight emissions{};  ///< and of what emission rays show
};

/// A pixel whose camera rays somebody sees.
struct WatchedPixel {
    FilmPlace place;
    const CameraSampleObserver& observer;
};

/// Renders blocks of tiles: the core loop.
class BlockRenderer {
public:
    /// @param frame  outlives this object
    explicit BlockRenderer(const FrameRequest& frame, std::optional<WatchedPixel> watched = {});

    /// Adds camera rays to the pixels of a block, as far as their tiles have so many.
    ///
    /// @param pixels    of the block's tiles
    /// @param progress  of the block
    /// @param counts    receives rays of light that bounces
    void addCameraRays(const TileBlock& block, RayRange rays, std::span<TilePixels> pixels,
                       BlockProgress& progress, BounceCounts& counts);

    /// The pixels of a tile as far as they are rendered.
    std::vector<Pixel> average(const TilePixels& tile) const;
    /// Their colours by light group; empty without groups.
    GroupedLight averageGroups(const TilePixels& tile) const;

    ToolPool& tools() { return tools_; }

private:
    /// Has work done for the tiles of a block, by number, in parallel.
    using Work = std::function<void(std::size_t number, TileTools& tools)>;
    void forEachTile(const TileBlock& block, const Work& work);
    /// Calls `visit` with batches of bounded memory of a tile's camera rays: the first pixel, and
    /// what they hold.
    using Visit = std::function<void(std::size_t firstPixel, const BatchPixels&)>;
    void forEachBatch(const TilePixels& tile, RayRange rays, const Visit& visit) const;
    RayRange raysOf(const BlockTile& tile, RayRange rays) const;
    /// Has light bounce to all places of a block.
    void bounceLight(std::span<std::vector<RayBatch>> tiles, BlockProgress& progress,
                     BounceCounts& counts) const;
    /// Adds what emission rays show to some pixels of a tile.
    void addEmission(std::size_t firstPixel, const BatchPixels& pixels, TilePixels& tile,
                     TileTools& tools) const;
    std::optional<std::uint32_t> watchedIn(std::span<const FilmPlace> places) const;
    void addToTile(const RayBatch& batch, TilePixels& tile) const;

    const FrameRequest& frame_;
    const std::optional<WatchedPixel> watched_;
    const FilmRays film_;
    const SpreadRule spread_;
    const BounceLight bounces_;
    ToolPool tools_;
};

}  // namespace shadowcache
