// What a tile's pixels are predicted to show, before any of their camera rays is sent.

#include <algorithm>

#include "common/base/tuned.h"
#include "common/random/salts.h"
#include "common/random/sequence.h"
#include "render/estimators/set_place.h"
#include "render/frame/tile_renderer.h"

namespace shadowcache {

namespace {

/// A pixel has one camera ray that decides how many it gets for so many that are asked for.
SHADOWCACHE_TUNED(int, kRaysOfSpreadRay, 8);

}  // namespace

std::vector<PredictedSpread> TileRenderer::predictSpreads(std::span<const FilmPlace> places,
                                                          int count, TileScratch& scratch,
                                                          Workspace& workspace) const {
    std::vector<PredictedSpread> spreads(places.size());
    if (!estimator_.prediction()) return spreads;
    scratch.rays.clear();
    for (std::size_t i = 0; i < places.size(); ++i) {
        const auto [x, y] = places[i];
        aim(places[i], static_cast<std::uint32_t>(i),
            hashWords(pixelSeed(options_.seed, number_, x, y, -1), RenderSalt::spreadRays), 0,
            count, scratch);
    }
    scratch.spreadRays += scratch.rays.size();
    intersect(scratch.rays);
    const Environment& environment = context_.environment;
    for (const TileScratch::Ray& ray : scratch.rays)
        spreads[ray.pixel].add(static_cast<double>(
            environment.luminance(predictRadiance(ray.view, places[ray.pixel], workspace))));
    return spreads;
}

Rgb TileRenderer::predictRadiance(const View& view, const FilmPlace&,
                                  Workspace& workspace) const {
    if (!view.hit.found) return skyAlong(view.direction);
    const Surface surface = surfaceOf(view.hit, options_.plain);
    if (surface.unlit) return surface.emission;
    // Gloss as if it were diffuse.
    const SetPlace at = placeOf(view);
    Rgb irradiance = estimator_.prediction()->predict(at, workspace);
    if (options_.bounces != 0 && context_.solve) {
        const ItemTable& items = context_.solve->items();
        const std::uint32_t item = items.itemAt(at.position, at.geometricNormal);
        if (item != kNoItem) irradiance += context_.solve->indirect(item, options_.bounces);
    }
    return surface.emission + surface.baseColor * irradiance * static_cast<float>(1 / kPi);
}

void TileRenderer::planPixels(std::span<const FilmPlace> places, TileScratch& scratch,
                              Workspace& workspace, std::span<PixelSum> sums) const {
    // By the size of a pass, so that n passes are those of the whole.
    const int pass = std::min(options_.cameraRays, options_.passRays);
    const int count = std::clamp(pass / kRaysOfSpreadRay, 1, kMostSpreadRays);
    const std::vector<PredictedSpread> around =
        withNeighbors(places, predictSpreads(places, count, scratch, workspace));
    for (std::size_t i = 0; i < sums.size(); ++i) {
        sums[i].rayFactor = rayFactorOf(around[i], *plan_.antialiasing);
        sums[i].errorScale = around[i].errorScale(plan_.antialiasing->floor);
    }
}

}  // namespace shadowcache
