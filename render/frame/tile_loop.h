#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "common/base/pool.h"
#include "render/frame/tile_renderer.h"

namespace shadowcache {

/// What a thread lights tiles with.
struct TileTools {
    std::unique_ptr<Workspace> workspace;
    TileScratch scratch;
    std::vector<FilmPlace> places;
};

/// Workspaces that go from one chunk of a frame to the next: what one has met is kept, its memory
/// too.
class Workspaces {
public:
    explicit Workspaces(const Estimator& estimator) : estimator_(estimator) {}

    std::unique_ptr<TileTools> take();
    void giveBack(std::unique_ptr<TileTools> tools);

    /// Adds times and counts of all that were given back since the last call.
    void addCounts(RenderStats& stats);

private:
    const Estimator& estimator_;
    Pool<TileTools> pool_;
};

/// Rays that pixels took.
struct RayCounts {
    std::uint64_t camera = 0, shadow = 0, reused = 0;

    void add(const Pixel& pixel);
    void add(const RayCounts& other);
    void addTo(RenderStats& stats) const;
};

/// A tile whose turn it is.
struct TileTurn {
    std::size_t index;  ///< in the list of tiles
    std::span<const FilmPlace> places;
    TileScratch& scratch;
    Workspace& workspace;
};

/// The tile loop: has `work` done for each of `tiles`, in parallel, and keeps the time.
void forEachTile(const FrameRequest& frame, std::span<const std::size_t> tiles,
                 Workspaces& workspaces, RenderStats& stats,
                 const std::function<void(const TileTurn&)>& work);

}  // namespace shadowcache
