#pragma once

#include <memory>

#include "common/base/pool.h"
#include "render/frame/frame_request.h"

namespace shadowcache {

/// What a thread lights tiles with.
struct TileTools {
    std::unique_ptr<Workspace> workspace;
    std::uint64_t spreadRays = 0;    ///< camera rays that are none of the picture's
    std::uint64_t emissionRays = 0;  ///< FilmRays::castEmission()
};

/// Tools that go from one chunk of a frame to the next: what one has met is kept, its memory too.
class ToolPool {
public:
    explicit ToolPool(const Estimator& estimator) : estimator_(estimator) {}

    std::unique_ptr<TileTools> take();
    void giveBack(std::unique_ptr<TileTools> tools) { pool_.giveBack(std::move(tools)); }

    /// Adds times and counts of all that were given back since the last call.
    void addCounts(RenderStats& stats);

private:
    const Estimator& estimator_;
    Pool<TileTools> pool_;
};

}  // namespace shadowcache
