#include "render/frame/block_renderer.h"

#include <algorithm>

#include "common/base/interrupt.h"
#include "common/base/parallel.h"
#include "render/estimators/light_groups.h"
#include "render/estimators/set_place.h"
#include "render/frame/predicted_rates.h"
#include "render/frame/shading.h"

namespace shadowcache {

namespace {

/// Samples of a batch, at most, so that its memory is bounded for any number of samples.
constexpr int kBatchSamples = 1 << 21;

/// Tiles that a thread takes at a time.
constexpr std::size_t kTilesOfChunk = 4;

}  // namespace

BlockRenderer::BlockRenderer(const FrameRequest& frame, std::optional<WatchedPixel> watched)
    : frame_(frame),
      watched_(watched),
      film_(frame),
      spread_(spreadRuleOf(frame)),
      bounces_(frame.estimator, frame.plan.vertices.get(), bounceOptionsOf(frame)),
      tools_(frame.estimator) {}

void BlockRenderer::addCameraRays(const TileBlock& block, RayRange rays,
                                  std::span<TilePixels> pixels, BlockProgress& progress,
                                  BounceCounts& counts) {
    const bool bounces = frame_.options.bounces != 0;
    std::vector<std::vector<RayBatch>> waiting(block.size());
    forEachTile(block, [&](std::size_t t, TileTools& tools) {
        TilePixels& tile = pixels[t];
        if (tile.places.empty()) {
            Tiles(frame_.options).findPlaces(block[t].tile, tile.places);
            tile.sums.resize(tile.places.size());
            if (const LightGroups* groups = frame_.estimator.context().groups)
                for (GroupedLight* sums : {&tile.groups, &tile.emissions})
                    sums->assign(tile.places.size(), groups->size());
        }
        const RayRange ofTile = raysOf(block[t], rays);
        if (ofTile.first == 0 && ofTile.count > 0) {
            tile.rates = ratesOf(frame_, film_, tile.places, tools);
            for (std::size_t i = 0; i < tile.rates.size(); ++i)
                tile.sums[i].apart.factor = tile.rates[i].emissionFactor;
        }
        forEachBatch(tile, ofTile, [&](std::size_t first, const BatchPixels& some) {
            if (block[t].index) addEmission(first, some, tile, tools);
            RayBatch batch{first, film_.cast(some), {}, {}, {}, {}};
            batch.met = placesOf(frame_, some, batch.rays);
            if (block[t].index)
                batch.direct = lightDirectly(frame_, some, batch.met, watchedIn(some.places),
                                             *tools.workspace);
            if (bounces)
                waiting[t].push_back(std::move(batch));
            else
                addToTile(batch, tile);
        });
        progress.add(1);
    });
    if (!bounces) return;

    bounceLight(waiting, progress, counts);
    forEachTile(block, [&](std::size_t t, TileTools&) {
        if (!block[t].index) return;
        for (const RayBatch& batch : waiting[t]) addToTile(batch, pixels[t]);
    });
}

void BlockRenderer::bounceLight(std::span<std::vector<RayBatch>> tiles, BlockProgress& progress,
                                BounceCounts& counts) const {
    std::vector<BounceReceiver> receivers;
    for (const std::vector<RayBatch>& tile : tiles)
        for (const RayBatch& batch : tile) addReceivers(batch.met, receivers);
    std::vector<BouncedLight> light(receivers.size());
    const RenderOptions& options = frame_.options;
    GroupedBounce grouped;
    if (options.preview || options.samples == 0) grouped = bounces_.predict(receivers, light);
    if (options.samples == 0) {
        for (BouncedLight& l : light) l.irradiance = l.predicted;
    } else {
        // Fewer paths go on from each level to the next: it is taken for half of what is left.
        std::size_t left = tiles.size();
        grouped = bounces_.gather(receivers, light, counts, [&] {
            progress.add(left / 2);
            left -= left / 2;
        });
        progress.add(left);
    }
    auto next = light.begin();
    for (std::vector<RayBatch>& tile : tiles)
        for (RayBatch& batch : tile) {
            const auto end = next + static_cast<std::ptrdiff_t>(batch.met.places.size());
            batch.bounced.assign(next, end);
            const auto first = static_cast<std::size_t>(next - light.begin());
            for (auto part : {&GroupedBounce::irradiance, &GroupedBounce::glossy})
                batch.groupedBounced.*part =
                    GroupedLight::part(grouped.*part, first, batch.bounced.size());
            next = end;
        }
}

void BlockRenderer::forEachTile(const TileBlock& block, const Work& work) {
    parallelFor(block.size(), kTilesOfChunk, [&](const Chunk& chunk) {
        std::unique_ptr<TileTools> tools = tools_.take();
        for (std::size_t t = chunk.begin; t < chunk.end; ++t) {
            throwIfInterrupted();
            work(t, *tools);
        }
        tools_.giveBack(std::move(tools));
    });
}

void BlockRenderer::forEachBatch(const TilePixels& tile, RayRange rays, const Visit& visit) const {
    const std::span<const FilmPlace> places(tile.places);
    const int samples = std::max(1, frame_.options.samples);
    const auto run = static_cast<std::size_t>(std::max(1, kBatchSamples / samples));
    for (std::size_t first = 0; first < places.size(); first += run) {
        const std::size_t some = std::min(run, places.size() - first);
        const int most = std::clamp(static_cast<int>(run / some), 1, frame_.options.passRays);
        const int end = rays.first + rays.count;
        for (int k = rays.first; k < end; k += most) {
            throwIfInterrupted();  // a tile may have millions of rays
            visit(first, {places.subspan(first, some),
                          std::span(tile.rates).subspan(first, some),
                          {k, std::min(most, end - k)}});
        }
    }
}

RayRange BlockRenderer::raysOf(const BlockTile& tile, RayRange rays) const {
    // What is planned tile by tile leaves out those that are not asked for.
    int count = frame_.tileRays.empty() ? frame_.options.cameraRays : 0;
    if (tile.index) count = frame_.raysOfTile(*tile.index);
    return {rays.first, std::clamp(count - rays.first, 0, rays.count)};
}

void BlockRenderer::addEmission(std::size_t firstPixel, const BatchPixels& pixels, TilePixels& tile,
                                TileTools& tools) const {
    for (std::size_t i = 0; i < pixels.places.size(); ++i) {
        const int factor = pixels.rates[i].emissionFactor;
        if (factor == 0) continue;
        const RayRange range{pixels.rays.first * factor, pixels.rays.count * factor};
        for (const FilmRay& ray : film_.castEmission(pixels.places[i], range)) {
            const Hit& hit = ray.view.hit;
            const Rgb ofSurface =
                hit.found ? surfaceSeen(hit, frame_.options.plain).emission : Rgb(0, 0, 0);
            std::span<Rgb> byGroup;
            if (!tile.emissions.empty()) byGroup = tile.emissions[firstPixel + i];
            tile.sums[firstPixel + i].apart.add(emissionSeen(frame_, ray, ofSurface, byGroup),
                                                spread_);
        }
        tools.emissionRays += static_cast<std::uint64_t>(range.count);
    }
}

std::optional<std::uint32_t> BlockRenderer::watchedIn(std::span<const FilmPlace> places) const {
    if (!watched_) return {};
    const auto found = std::ranges::find(places, watched_->place);
    if (found == places.end()) return {};
    return static_cast<std::uint32_t>(found - places.begin());
}

void BlockRenderer::addToTile(const RayBatch& batch, TilePixels& tile) const {
    if (watched_) showTo(watched_->observer, watched_->place, frame_, batch);
    addToFilm(frame_, spread_, batch, tile.sums);
    if (frame_.estimator.context().groups) addToGroups(frame_, batch, tile.sums, tile.groups);
}

std::vector<Pixel> BlockRenderer::average(const TilePixels& tile) const {
    std::vector<Pixel> pixels;
    pixels.reserve(tile.sums.size());
    for (const PixelSum& sum : tile.sums) pixels.push_back(sum.average(spread_));
    return pixels;
}

GroupedLight BlockRenderer::averageGroups(const TilePixels& tile) const {
    GroupedLight colors = tile.groups;
    for (std::size_t i = 0; !colors.empty() && i < tile.sums.size(); ++i) {
        for (Rgb& color : colors[i])
            color *= 1.0f / static_cast<float>(std::max(1, tile.sums[i].cameraRays));
        addTo(colors[i], tile.emissions[i],
              Rgb(1.0f / static_cast<float>(std::max(1, tile.sums[i].apart.rays))));
    }
    return colors;
}

}  // namespace shadowcache
