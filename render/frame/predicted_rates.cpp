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

/// Radiance that a surface is predicted to reflect.
Rgb predictReflected(const FrameRequest& frame, const View& view, const Surface& surface,
                     Workspace& workspace) {
    if (surface.unlit) return {0, 0, 0};
    const RenderOptions& options = frame.options;
    const EstimatorContext& context = frame.estimator.context();
    // Gloss as if it were diffuse.
    const SetPlace at = placeOf(context.scene, view);
    Rgb irradiance = frame.estimator.prediction()->predict(at, workspace);
    if (options.bounces != 0 && context.solve) {
        const ItemTable& items = context.solve->items();
        const std::uint32_t item = items.itemAt(at.position, at.geometricNormal);
        if (item != kNoItem) irradiance += context.solve->indirect(item, options.bounces);
    }
    const Rgb share = reflectance(surface, -at.normal.dot(view.direction));
    return share * irradiance * static_cast<float>(1 / kPi);
}

/// Adds what a camera ray is predicted to see.
void addTo(PredictedSpread& spread, const FrameRequest& frame, const FilmRay& ray,
           Workspace& workspace) {
    const Environment& environment = frame.estimator.context().environment;
    const auto luminance = [&](const Rgb& radiance) {
        return static_cast<double>(environment.luminance(radiance));
    };
    const Rgb lamps = lampsSeen(frame, ray);
    if (!ray.view.hit.found) {
        spread.add(0, luminance(skySeen(frame, ray.view) + lamps));
        return;
    }
    const Surface surface = surfaceSeen(ray.view.hit, frame.options.plain);
    spread.add(luminance(predictReflected(frame, ray.view, surface, workspace)),
               luminance(surface.emission + lamps));
}

}  // namespace

std::vector<PredictedSpread> predictSpreads(const FrameRequest& frame, const FilmRays& film,
                                            std::span<const FilmPlace> places, int count,
                                            TileTools& tools) {
    std::vector<PredictedSpread> spreads(places.size());
    if (!frame.estimator.prediction()) return spreads;
    const std::vector<FilmRay> rays = film.castExtra(places, count);
    tools.spreadRays += rays.size();
    for (const FilmRay& ray : rays) addTo(spreads[ray.pixel], frame, ray, *tools.workspace);
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
    for (std::size_t i = 0; i < rates.size(); ++i) rates[i] = rateOf(around[i], rule);
    return rates;
}

}  // namespace shadowcache
