#include "render/frame/film_sum.h"

#include <algorithm>
#include <vector>

#include "render/estimators/light_groups.h"
#include "render/frame/shading.h"

namespace shadowcache {

namespace {

/// Light of a place that a camera ray met.
struct PlaceLight {
    Estimate irradiance;  ///< all of it, as `gloss`
    GlossEstimate gloss;
    BouncedLight bounced;
};

PlaceLight lightOf(const FrameRequest& frame, const RayBatch& batch, std::size_t number) {
    const MetPlace& place = batch.met.places[number];
    PlaceLight light;
    if (place.diffuse) light.irradiance = batch.direct.irradiance[*place.diffuse];
    if (place.glossy) light.gloss = batch.direct.gloss[*place.glossy];
    if (batch.bounced.empty()) return light;
    light.bounced = batch.bounced[number];
    const float exposed = 1 / light.bounced.exposure;
    light.irradiance.predicted *= exposed;
    if (frame.options.samples == 0) light.irradiance.irradiance *= exposed;
    light.irradiance.irradiance += light.bounced.irradiance;
    light.irradiance.predicted += light.bounced.predicted;
    light.gloss.radiance += light.bounced.glossy;
    return light;
}

/// What a camera ray shows of a place, by its share: `surface` has that already (surfaceSeen).
///
/// @param emission  that it shows as well
RayValues valuesOf(const FilmRay& ray, const MetPlace& place, const PlaceLight& light,
                   const Rgb& emission) {
    const Surface& surface = place.surface;
    const auto reflected = [&](const Rgb& irradiance) {
        return place.diffuseAlbedo * irradiance * static_cast<float>(1 / kPi);
    };
    const Rgb diffuse = reflected(light.irradiance.irradiance), glossy = light.gloss.radiance;
    const float share = ray.view.hit.share;
    const double depth = static_cast<double>(ray.view.hit.distance) + ray.ray.skipped;
    return {.color = diffuse + glossy + emission,
            .diffuse = diffuse,
            .glossy = glossy,
            .diffuseIndirect = reflected(light.bounced.irradiance),
            .glossyIndirect = light.bounced.glossy,
            .emission = emission,
            .predicted = reflected(light.irradiance.predicted) + (glossy + emission),
            .irradiance = light.irradiance.irradiance * share,
            .albedo = surface.baseColor,
            .diffuseAlbedo = place.diffuseAlbedo,
            .mirrorColor = surface.glossy ? surface.f0 : Rgb(0, 0, 0),
            .roughness = surface.roughness * share,
            .normal = place.point.place.normal * share,
            .position = Vec3f(place.point.place.position) * share,
            .depth = static_cast<float>(depth) * share,
            .axialDepth = static_cast<float>(depth * ray.ray.cosine) * share,
            .alpha = ray.view.hit.covered,
            .coverage = share};
}

/// Adds what a camera ray shows reflected by a place, by light group; as lightOf() and valuesOf()
/// do.
void addReflected(const FrameRequest& frame, const RayBatch& batch, std::size_t number,
                  std::span<Rgb> sum) {
    const MetPlace& place = batch.met.places[number];
    const GroupedBounce& bounced = batch.groupedBounced;
    const Rgb reflected = place.diffuseAlbedo * static_cast<float>(1 / kPi), all(1, 1, 1);
    float exposed = 1;
    if (frame.options.samples == 0 && !batch.bounced.empty())
        exposed = 1 / batch.bounced[number].exposure;
    if (place.diffuse)
        addTo(sum, batch.direct.groupedIrradiance[*place.diffuse], reflected * exposed);
    if (place.glossy) addTo(sum, batch.direct.groupedGloss[*place.glossy], all);
    if (!bounced.irradiance.empty()) addTo(sum, bounced.irradiance[number], reflected);
    if (!bounced.glossy.empty()) addTo(sum, bounced.glossy[number], all);
}

/// Adds what the cache predicts at a place.
///
/// @param share  of the camera ray
void addInsight(const CacheInsight& insight, float share, PixelSum& pixel, RayValues& values) {
    const float noise = insight.expectedNoise * share;
    pixel.expectedVariance += noise * noise;
    values.openness = insight.openness * share;
    values.items = static_cast<float>(insight.items) * share;
    values.regions = static_cast<float>(insight.regions) * share;
    values.misses = insight.items == 0 ? share : 0.0f;
}

}  // namespace

SpreadRule spreadRuleOf(const FrameRequest& frame) {
    const RenderOptions& options = frame.options;
    const int fewest =
        frame.tileRays.empty() ? options.cameraRays : *std::ranges::min_element(frame.tileRays);
    return {spreadRunLength(std::min(fewest, options.passRays)),
            frame.estimator.context().environment.luminanceWeights()};
}

void addToFilm(const FrameRequest& frame, const SpreadRule& rule, const RayBatch& batch,
               std::span<PixelSum> tile) {
    std::size_t met = 0;
    for (const FilmRay& ray : batch.rays) {
        PixelSum& pixel = tile[batch.firstPixel + ray.pixel];
        const MetPlace* place = ray.view.hit.found ? &batch.met.places[met] : nullptr;
        SeenEmission emission;
        if (pixel.apart.factor == 0)
            emission = emissionSeen(frame, ray, place ? place->surface.emission : Rgb(0, 0, 0));
        if (!place) {
            pixel.addSky(emission, ray.view.hit, rule);
            continue;
        }
        const PlaceLight light = lightOf(frame, batch, met);
        RayValues values = valuesOf(ray, *place, light, emission.sum());
        if (!batch.direct.insights.empty())
            addInsight(batch.direct.insights[met], values.coverage, pixel, values);
        pixel.addHit(values, light.irradiance, light.gloss, rule);
        ++met;
    }
}

void addToGroups(const FrameRequest& frame, const RayBatch& batch, std::span<const PixelSum> sums,
                 GroupedLight& tile) {
    std::size_t met = 0;
    for (const FilmRay& ray : batch.rays) {
        const std::size_t pixel = batch.firstPixel + ray.pixel;
        const bool hit = ray.view.hit.found;
        if (sums[pixel].apart.factor == 0)
            emissionSeen(frame, ray, hit ? batch.met.places[met].surface.emission : Rgb(0, 0, 0),
                         tile[pixel]);
        if (hit) addReflected(frame, batch, met++, tile[pixel]);
    }
}

void showTo(const CameraSampleObserver& observer, const FilmPlace& pixel, const FrameRequest& frame,
            const RayBatch& batch) {
    for (std::size_t i = 0; i < batch.met.places.size(); ++i) {
        const MetPlace& place = batch.met.places[i];
        const BatchSlot& slot = place.point.slot;
        if (slot.filmX != pixel.x || slot.filmY != pixel.y) continue;
        const PlaceLight light = lightOf(frame, batch, i);
        std::vector<Vec3f> directions;
        for (const WatchedSample& sample : batch.direct.watched)
            if (sample.cameraRay == slot.cameraRay) directions.push_back(sample.direction);
        observer(
            {place.point, place.surface, place.share, light.irradiance, light.gloss, directions});
    }
}

}  // namespace shadowcache
