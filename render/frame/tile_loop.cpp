#include "render/frame/tile_loop.h"

#include <utility>

#include "common/base/parallel.h"
#include "common/base/progress.h"
#include "render/frame/time_keeper.h"

namespace shadowcache {

void RayCounts::add(const Pixel& pixel) {
    camera += static_cast<std::uint64_t>(pixel.cameraRays);
    shadow += static_cast<std::uint64_t>(pixel.rays);
    reused += static_cast<std::uint64_t>(pixel.reusedRays);
}

void RayCounts::add(const RayCounts& other) {
    camera += other.camera;
    shadow += other.shadow;
    reused += other.reused;
}

void RayCounts::addTo(RenderStats& stats) const {
    stats.cameraRays += camera;
    stats.shadowRays += shadow;
    stats.reusedRays += reused;
}

std::unique_ptr<TileTools> Workspaces::take() {
    return pool_.take([&] {
        auto tools = std::make_unique<TileTools>();
        tools->workspace = estimator_.makeWorkspace();
        return tools;
    });
}

void Workspaces::giveBack(std::unique_ptr<TileTools> tools) {
    pool_.giveBack(std::move(tools));
}

void Workspaces::addCounts(RenderStats& stats) {
    std::uint64_t setup = 0, trace = 0;
    pool_.forEach([&](TileTools& tools) {
        Workspace& workspace = *tools.workspace;
        setup += std::exchange(workspace.setupNanoseconds, 0);
        trace += std::exchange(workspace.traceNanoseconds, 0);
        stats.raysWithoutItems += std::exchange(workspace.pointsWithoutItems, 0);
        stats.spreadRays += std::exchange(tools.scratch.spreadRays, 0);
    });
    stats.setupSeconds += static_cast<double>(setup) * 1e-9 / threadCount();
    stats.traceSeconds += static_cast<double>(trace) * 1e-9 / threadCount();
}

void forEachTile(const FrameRequest& frame, std::span<const std::size_t> tiles,
                 Workspaces& workspaces, RenderStats& stats,
                 const std::function<void(const TileTurn&)>& work) {
    const TimeKeeper time(stats);
    const Tiles all(frame.options);
    parallelFor(tiles.size(), 4, [&](const Chunk& chunk) {
        std::unique_ptr<TileTools> tools = workspaces.take();
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            throwIfInterrupted();
            all.findPlaces(tiles[i], tools->places);
            work({i, tools->places, tools->scratch, *tools->workspace});
        }
        workspaces.giveBack(std::move(tools));
    });
    workspaces.addCounts(stats);
}

}  // namespace shadowcache
