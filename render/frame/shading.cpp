#include "render/frame/shading.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/estimators/emitter_light.h"
#include "render/estimators/group_split.h"
#include "render/estimators/light_groups.h"
#include "render/estimators/set_place.h"

namespace shadowcache {

SetPlace placeOf(const Scene& scene, const View& view) {
    return {rayStartOf(scene, view), worldPosition(scene, view.hit), view.shadingNormal(),
            view.geometricNormal()};
}

Rgb skySeen(const FrameRequest& frame, const View& view) {
    if (frame.options.transparent) return {0, 0, 0};
    return frame.estimator.context().environment.radiance(view.direction) * view.hit.tint *
           view.hit.share;
}

Rgb lampsSeen(const FrameRequest& frame, const FilmRay& ray, std::span<Rgb> byGroup) {
    const EstimatorContext& context = frame.estimator.context();
    Rgb sum(0, 0, 0);
    if (!context.emitters) return sum;
    const View& view = ray.view;
    const float distance =
        view.hit.found ? view.hit.distance : std::numeric_limits<float>::infinity();
    for (const EmitterLight::SeenLamp& lamp :
         context.emitters->lampsSeen(startIn(context.scene, ray.ray), view.direction, distance)) {
        // Beyond the far plane suns alone are seen, as the sky is.
        if (std::isfinite(lamp.distance) && static_cast<double>(lamp.distance) > ray.ray.reach)
            continue;
        const Rgb shown = lamp.radiance * view.hit.share;
        sum += shown;
        if (!byGroup.empty()) byGroup[context.groups->ofPart(lamp.part)] += shown;
    }
    return sum;
}

SeenEmission emissionSeen(const FrameRequest& frame, const FilmRay& ray, const Rgb& ofSurface,
                          std::span<Rgb> byGroup) {
    SeenEmission seen;
    seen.lamps = lampsSeen(frame, ray, byGroup);
    if (ray.view.hit.found)
        seen.surface = ofSurface;
    else
        seen.sky = skySeen(frame, ray.view);
    if (!byGroup.empty()) {
        byGroup[LightGroups::kSky] += seen.sky;
        if (ofSurface != Rgb(0, 0, 0))
            byGroup[frame.estimator.context().groups->ofHit(ray.view.hit)] += ofSurface;
    }
    return seen;
}

float irradianceScale(const Environment& environment, double radiance, const Rgb& albedo) {
    // On black, no error is seen.
    const double share = std::max(static_cast<double>(environment.luminance(albedo)), 1e-6);
    const auto most = static_cast<double>(std::numeric_limits<float>::max());
    return static_cast<float>(std::min(kPi * radiance / share, most));
}

MetPlaces placesOf(const FrameRequest& frame, const BatchPixels& batch,
                   std::span<const FilmRay> rays) {
    const EstimatorContext& context = frame.estimator.context();
    const RenderOptions& options = frame.options;
    MetPlaces met;
    met.places.reserve(rays.size());  // glossyPoints refer to them
    for (const FilmRay& ray : rays) {
        if (!ray.view.hit.found) continue;
        const FilmPlace& pixel = batch.places[ray.pixel];
        const AdaptiveRate& rate = batch.rates[ray.pixel];
        const SetPlace at = placeOf(context.scene, ray.view);
        const Surface surface = surfaceSeen(ray.view.hit, options.plain);
        const Rgb albedo = diffuseAlbedo(surface, -at.normal.dot(ray.view.direction));
        const BatchSlot slot{
            .seed = pixelSeed(options.seed, frame.number, pixel.x, pixel.y, 0),
            .filmX = pixel.x,
            .filmY = pixel.y,
            .cameraRay = static_cast<std::uint32_t>(ray.number),
            .row = static_cast<std::uint32_t>(ray.number / rate.rayFactor - batch.rays.first),
            .pixel = ray.pixel,
            .errorScale = irradianceScale(context.environment, rate.errorScale, albedo),
            .sampleFraction = 1.0f / static_cast<float>(rate.rayFactor)};
        MetPlace& place = met.places.emplace_back(MetPlace{.point = {at, slot},
                                                           .surface = surface,
                                                           .diffuseAlbedo = albedo,
                                                           .share = ray.view.hit.share});
        // Of a Lambertian surface the irradiance is told, however black it is.
        if (albedo != Rgb(0.0f) || !(surface.glossy || surface.unlit)) {
            place.diffuse = static_cast<std::uint32_t>(met.points.size());
            met.points.push_back(place.point);
        }
        if (surface.glossy) {
            place.glossy = static_cast<std::uint32_t>(met.glossyPoints.size());
            met.glossyPoints.push_back(
                {place.point, GlossyLobe(surface, at.normal, -ray.view.direction)});
        }
    }
    return met;
}

DirectLight lightDirectly(const FrameRequest& frame, const BatchPixels& pixels,
                          const MetPlaces& met, std::optional<std::uint32_t> watched,
                          Workspace& workspace) {
    const RenderOptions& options = frame.options;
    const EstimatorPlan* plan = frame.plan.estimator.get();
    const int mostRays =
        std::ranges::max(pixels.rates, {}, &AdaptiveRate::rayFactor).rayFactor * pixels.rays.count;
    const PointBatch batch{.points = met.points,
                           .samples = options.samples,
                           .pixels = static_cast<std::uint32_t>(pixels.places.size()),
                           .cameraRays = static_cast<std::uint32_t>(mostRays),
                           .predict = options.preview,
                           .plan = plan};
    DirectLight light;
    light.irradiance.resize(met.points.size());
    light.gloss.resize(met.glossyPoints.size());
    workspace.watchedPixel = watched;
    workspace.watched.clear();
    frame.estimator.estimate(batch, workspace, light.irradiance);
    light.watched = workspace.watched;
    const EstimatorContext& context = frame.estimator.context();
    light.groupedIrradiance =
        splitLight<Estimate>(context, light.irradiance, &Estimate::irradiance, workspace);
    if (!met.glossyPoints.empty()) {
        frame.estimator.estimateGloss(batch, met.glossyPoints, workspace, light.gloss);
        light.groupedGloss =
            splitLight<GlossEstimate>(context, light.gloss, &GlossEstimate::radiance, workspace);
    }
    const InsightSource* source = options.insight ? frame.estimator.insights() : nullptr;
    if (source)
        for (const MetPlace& place : met.places)
            light.insights.push_back(
                source->insight(place.point, options.samples, plan, workspace));
    return light;
}

void addReceivers(const MetPlaces& met, std::vector<BounceReceiver>& receivers) {
    for (const MetPlace& place : met.places)
        receivers.push_back({&place.point, place.diffuseAlbedo, place.diffuse.has_value(),
                             place.glossy ? &met.glossyPoints[*place.glossy].lobe : nullptr});
}

}  // namespace shadowcache
