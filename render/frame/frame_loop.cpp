#include "render/frame/frame_loop.h"

#include <algorithm>
#include <utility>

#include "common/base/parallel.h"
#include "render/frame/render_timer.h"

namespace shadowcache {

namespace {

/// Blocks of one tile that a thread takes at a time.
constexpr std::size_t kBlocksOfChunk = 4;

/// How far `passes` over a block are.
BlockProgress progressOf(const TileBlock& block, int passes, const LoopObserver& observer) {
    const auto wanted =
        std::ranges::count_if(block, [](const BlockTile& tile) { return tile.index.has_value(); });
    // Direct light and what bounces take about the same time.
    return {static_cast<std::size_t>(wanted), 2 * block.size() * static_cast<std::size_t>(passes),
            observer.onProgress};
}

}  // namespace

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

FrameLoop::FrameLoop(const FrameRequest& frame, std::vector<TileBlock> blocks,
                     std::optional<WatchedPixel> watched)
    : frame_(frame),
      blocks_(std::move(blocks)),
      renderer_(frame, watched),
      pixels_(blocks_.size()) {}

RayCounts FrameLoop::run(RayRange rays, RenderStats& stats, const LoopObserver& observer) {
    const RenderTimer time(stats);
    const std::size_t chunkSize = frame_.options.bounces != 0 ? 1 : kBlocksOfChunk;
    const bool isLast = rays.first + rays.count >= frame_.options.cameraRays;
    std::vector<RayCounts> counts(blocks_.size());
    std::vector<BounceCounts> bounces(blocks_.size());
    parallelFor(blocks_.size(), chunkSize, [&](const Chunk& chunk) {
        for (std::size_t b = chunk.begin; b < chunk.end; ++b) {
            observer.onBlock();
            render(b, rays, bounces[b], observer);
            counts[b] = finish(b, observer);
            if (isLast) pixels_[b] = {};
        }
    });
    renderer_.tools().addCounts(stats);
    RayCounts all;
    for (const RayCounts& count : counts) all.add(count);
    for (const BounceCounts& count : bounces) stats.bounces.add(count);
    return all;
}

void FrameLoop::render(std::size_t block, RayRange rays, BounceCounts& bounces,
                       const LoopObserver& observer) {
    const int pass = frame_.options.passRays, end = rays.first + rays.count;
    pixels_[block].resize(blocks_[block].size());
    BlockProgress progress = progressOf(blocks_[block], (rays.count + pass - 1) / pass, observer);
    for (int first = rays.first; first < end; first += pass)
        renderer_.addCameraRays(blocks_[block], {first, std::min(pass, end - first)},
                                pixels_[block], progress, bounces);
    progress.finish();
}

RayCounts FrameLoop::finish(std::size_t block, const LoopObserver& observer) const {
    RayCounts counts;
    for (std::size_t t = 0; t < blocks_[block].size(); ++t) {
        const std::optional<std::size_t> index = blocks_[block][t].index;
        if (!index) continue;
        const TilePixels& tile = pixels_[block][t];
        const std::vector<Pixel> pixels = renderer_.average(tile);
        for (const Pixel& pixel : pixels) counts.add(pixel);
        observer.onTile({*index, tile.places, pixels, renderer_.averageGroups(tile)});
    }
    return counts;
}

void renderTiles(const FrameRequest& frame, std::span<const std::size_t> tiles, BlockExtent extent,
                 RenderStats& stats, const LoopObserver& observer) {
    FrameLoop(frame, blocksOf(frame, tiles, extent))
        .run({0, frame.options.cameraRays}, stats, observer)
        .addTo(stats);
}

}  // namespace shadowcache
