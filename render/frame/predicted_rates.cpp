#include "render/frame/predicted_rates.h"

#include <algorithm>

#include "common/base/tuned.h"
#include "render/estimators/set_place.h"
#include "render/frame/shading.h"
#include "render/frame/visible_emitters.h"

namespace shadowcache {

namespace {

/// A pixel has one camera ray that decides how many it gets for so many that are asked for.
SHADOWCACHE_TUNED(int, kRaysOfSpreadRay, 8);

/// Radiance that a camera ray is predicted to see, but for lamps.
Rgb predictRadiance(const FrameRequest& frame, const View& view, Workspace& workspace) {
    if (!view.hit.found) return skySeen(frame, view);
    const RenderOptions& options = frame.options;
    const EstimatorContext& context = frame.estimator.context();
    const Surface surface = surfaceSeen(view.hit, options.plain);
    if (surface.unlit) return surface.emission;
    // Gloss as if it were diffuse.
    const SetPlace at = placeOf(context.scene, view);
    Rgb irradiance = frame.estimator.prediction()->predict(at, workspace);
    if (options.bounces != 0 && context.solve) {
        const ItemTable& items = context.solve->items();
        const std::uint32_t item = items.itemAt(at.position, at.geometricNormal);
        if (item != kNoItem) irradiance += context.solve->indirect(item, options.bounces);
    }
    return surface.emission + surface.baseColor * irradiance * static_cast<float>(1 / kPi);
}

}  // namespace

std::vector<PredictedSpread> predictSpreads(const FrameRequest& frame, const FilmRays& film,
                                            std::span<const FilmPlace> places, int count,
                                            TileTools& tools) {
    std::vector<PredictedSpread> spreads(places.size());
    if (!frame.estimator.prediction()) return spreads;
    const Environment& environment = frame.estimator.context().environment;
    const std::vector<FilmRay> rays = film.castExtra(places, count);
    tools.spreadRays += rays.size();
    for (const FilmRay& ray : rays)
        spreads[ray.pixel].add(static_cast<double>(environment.luminance(
            predictRadiance(frame, ray.view, *tools.workspace) + lampsSeen(frame, ray))));
    if (frame.plan.visibleEmitters)
        for (std::size_t i = 0; i < places.size(); ++i)
            frame.plan.visibleEmitters->addTo(places[i], spreads[i]);
    return spreads;
}

std::vector<AdaptiveRate> ratesOf(const FrameRequest& frame, const FilmRays& film,
                                  std::span<const FilmPlace> places, TileTools& tools) {
    std::vector<AdaptiveRate> rates(places.size());
    if (!frame.plan.antialiasing || places.empty()) return rates;
    const AntialiasingRule& rule = *frame.plan.antialiasing;
    // By the size of a pass, so that n passes are those of the whole.
    const int pass = std::min(frame.options.cameraRays, frame.options.passRays);
    const int count = std::clamp(pass / kRaysOfSpreadRay, 1, kMostSpreadRays);
    const std::vector<PredictedSpread> around =
        withNeighbors(places, predictSpreads(frame, film, places, count, tools));
    for (std::size_t i = 0; i < rates.size(); ++i)
        rates[i] = {rayFactorOf(around[i], rule), around[i].errorScale(rule.floor)};
    return rates;
}

}  // namespace shadowcache
