#include "render/frame/tile_tools.h"

#include <utility>

#include "common/base/parallel.h"

namespace shadowcache {

std::unique_ptr<TileTools> ToolPool::take() {
    return pool_.take(
        [&] { return std::make_unique<TileTools>(TileTools{estimator_.makeWorkspace()}); });
}

void ToolPool::addCounts(RenderStats& stats) {
    std::uint64_t setup = 0, trace = 0;
    pool_.forEach([&](TileTools& tools) {
        Workspace& workspace = *tools.workspace;
        setup += std::exchange(workspace.setupNanoseconds, 0);
        trace += std::exchange(workspace.traceNanoseconds, 0);
        stats.raysWithoutItems += std::exchange(workspace.pointsWithoutItems, 0);
        stats.spreadRays += std::exchange(tools.spreadRays, 0);
        stats.emissionRays += std::exchange(tools.emissionRays, 0);
    });
    stats.setupSeconds += static_cast<double>(setup) * 1e-9 / threadCount();
    stats.traceSeconds += static_cast<double>(trace) * 1e-9 / threadCount();
}

}  // namespace shadowcache
