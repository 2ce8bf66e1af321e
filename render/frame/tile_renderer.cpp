#include "render/frame/tile_renderer.h"

#include <algorithm>
#include <array>
#include <limits>

#include "common/base/interrupt.h"
#include "common/random/salts.h"
#include "common/random/sequence.h"
#include "render/estimators/set_place.h"

namespace shadowcache {

namespace {

/// Samples of a batch, at most, so that its memory is bounded for any number of samples.
constexpr int kBatchSamples = 1 << 21;

void addInsight(const CacheInsight& insight, PixelSum& pixel) {
    pixel.expectedVariance += insight.expectedNoise * insight.expectedNoise;
    pixel.sum.openness += insight.openness;
    pixel.sum.items += static_cast<float>(insight.items);
    pixel.sum.regions += static_cast<float>(insight.regions);
    pixel.sum.misses += insight.items == 0 ? 1.0f : 0.0f;
}

int fewestRays(const FrameRequest& request) {
    return request.tileRays.empty() ? request.options.cameraRays
                                    : *std::ranges::min_element(request.tileRays);
}

}  // namespace

TileRenderer::TileRenderer(const FrameRequest& request)
    : estimator_(request.estimator),
      context_(estimator_.context()),
      camera_(request.camera, static_cast<double>(request.options.width) / request.options.height),
      number_(request.number),
      options_(request.options),
      filter_(options_.filter, options_.filterWidth),
      runLength_(spreadRunLength(std::min(fewestRays(request), options_.passRays))),
      plan_(request.plan) {}

View TileRenderer::look(const FilmPosition& at) const {
    return lookAlong(camera_.through(at), context_.scene);
}

SetPlace TileRenderer::placeOf(const View& view) const {
    return {rayStartOf(context_.scene, view), worldPosition(context_.scene, view.hit),
            view.shadingNormal(), view.geometricNormal()};
}

Rgb TileRenderer::skyAlong(const Vec3f& direction) const {
    return options_.transparent ? Rgb(0, 0, 0) : context_.environment.radiance(direction);
}

float TileRenderer::irradianceScale(double radiance, const Rgb& albedo) const {
    // On black, no error is seen.
    const double share =
        std::max(static_cast<double>(context_.environment.luminance(albedo)), 1e-6);
    const auto most = static_cast<double>(std::numeric_limits<float>::max());
    return static_cast<float>(std::min(kPi * radiance / share, most));
}

void TileRenderer::aim(const FilmPlace& place, std::uint32_t pixel, std::uint64_t seed, int first,
                       int count, TileScratch& scratch) const {
    const auto draw = [&](std::size_t word, int dimension, std::uint64_t sequence) {
        scratch.words[word].resize(static_cast<std::size_t>(count));
        owenSobol(static_cast<std::uint32_t>(first), dimension, sequence, scratch.words[word]);
    };
    const auto number = [&](std::size_t word, int k) {
        return static_cast<double>(toUnitFloat(scratch.words[word][static_cast<std::size_t>(k)]));
    };
    const bool centered = options_.cameraRays == 1;
    if (!centered)
        for (const int d : {0, 1}) draw(static_cast<std::size_t>(d), d, seed);
    if (camera_.spread()) {
        for (const int d : {2, 3}) draw(static_cast<std::size_t>(d), d, seed);
        draw(4, 0, hashWords(seed, RenderSalt::shutterTime));
    }
    for (int k = 0; k < count; ++k) {
        const double dx = centered ? 0 : filter_.offset(number(0, k));
        const double dy = centered ? 0 : filter_.offset(number(1, k));
        const FilmPosition at{(place.x + (0.5 + dx)) / options_.width,
                              (place.y + (0.5 + dy)) / options_.height};
        const CameraRay ray = camera_.spread()
                                  ? camera_.through(at, {number(2, k), number(3, k), number(4, k)})
                                  : camera_.through(at);
        scratch.rays.push_back({pixel, first + k, k, ray, {Vec3f(ray.direction), {}}});
    }
}

/// Of neighbours eight at a time.
void TileRenderer::intersect(std::span<TileScratch::Ray> rays) const {
    constexpr auto kSize = static_cast<std::size_t>(RayPacket::kSize);
    RayPacket packet{};
    std::array<Hit, kSize> hits;
    for (std::size_t first = 0; first < rays.size(); first += kSize) {
        const auto some = rays.subspan(first, std::min(kSize, rays.size() - first));
        const auto count = static_cast<int>(some.size());
        for (int i = 0; i < count; ++i) {
            const TileScratch::Ray& ray = some[static_cast<std::size_t>(i)];
            packet.set(i, startIn(context_.scene, ray.ray), ray.view.direction);
        }
        context_.scene.intersect(packet, count, hits.data());
        for (std::size_t i = 0; i < some.size(); ++i)
            if (static_cast<double>(hits[i].distance) <= some[i].ray.reach)
                some[i].view.hit = hits[i];
    }
}

std::optional<ShadingPoint> TileRenderer::pilotPoint(const FilmPosition& at, std::uint64_t seed,
                                                     std::optional<double> floor,
                                                     TileScratch& scratch,
                                                     Workspace& workspace) const {
    const View view = look(at);
    if (!view.hit.found) return {};
    const FilmPlace pixel{static_cast<int>(at.x * options_.width),
                          static_cast<int>(at.y * options_.height)};
    const SetPlace place = placeOf(view);
    BatchSlot slot{.seed = seed, .filmX = pixel.x, .filmY = pixel.y};
    if (floor) {
        const double scale =
            predictSpreads(std::span(&pixel, 1), kMostSpreadRays, scratch, workspace)
                .front()
                .errorScale(*floor);
        const Rgb albedo =
            diffuseAlbedo(surfaceOf(view.hit, options_.plain), -place.normal.dot(view.direction));
        slot.errorScale = irradianceScale(scale, albedo);
    }
    return ShadingPoint{place, slot};
}

template <class Visit>
void TileRenderer::forEachBatch(std::size_t pixels, int first, int count,
                                const Visit& visit) const {
    const int samples = std::max(1, options_.samples);
    const auto run = static_cast<std::size_t>(std::max(1, kBatchSamples / samples));
    for (std::size_t p = 0; p < pixels; p += run) {
        const std::size_t some = std::min(run, pixels - p);
        const int rays = std::clamp(static_cast<int>(run / some), 1, options_.passRays);
        for (int k = first; k < first + count; k += rays) {
            throwIfInterrupted();  // a tile may have millions of rays
            visit(p, some, k, std::min(rays, first + count - k));
        }
    }
}

void TileRenderer::addCameraRays(std::span<const FilmPlace> places, int first, int count,
                                 TileScratch& scratch, Workspace& workspace,
                                 std::span<PixelSum> sums) const {
    if (places.empty()) return;
    if (plan_.antialiasing && first == 0) planPixels(places, scratch, workspace, sums);
    forEachBatch(
        places.size(), first, count, [&](std::size_t p, std::size_t some, int k, int rays) {
            lightBatch(places.subspan(p, some), k, rays, scratch, workspace, sums.subspan(p, some));
            addBatch(scratch, workspace, sums.subspan(p, some));
        });
}

void TileRenderer::lightCameraRays(std::span<const FilmPlace> places, int first, int count,
                                   Lighting lighting, TileScratch& scratch, Workspace& workspace,
                                   std::span<PixelSum> sums,
                                   std::vector<TileBatch>& batches) const {
    batches.clear();
    if (places.empty()) return;
    if (plan_.antialiasing && first == 0) planPixels(places, scratch, workspace, sums);
    forEachBatch(
        places.size(), first, count, [&](std::size_t p, std::size_t some, int k, int rays) {
            TileBatch& batch = batches.emplace_back(TileBatch{p, some, {}});
            if (lighting == Lighting::none)
                meetBatch(places.subspan(p, some), k, rays, batch.scratch, sums.subspan(p, some));
            else
                lightBatch(places.subspan(p, some), k, rays, batch.scratch, workspace,
                           sums.subspan(p, some));
        });
}

void TileRenderer::addBatches(std::span<const TileBatch> batches, Workspace& workspace,
                              std::span<PixelSum> sums) const {
    for (const TileBatch& batch : batches)
        addBatch(batch.scratch, workspace, sums.subspan(batch.firstPixel, batch.pixels));
}

void TileRenderer::findReceivers(const TileScratch& scratch,
                                 std::vector<BounceReceiver>& receivers) const {
    for (const TileScratch::Place& place : scratch.places)
        receivers.push_back({&place.point, place.diffuseAlbedo, place.diffuse.has_value(),
                             place.glossy ? &scratch.glossyPoints[*place.glossy].lobe : nullptr});
}

PointBatch TileRenderer::batchOf(std::span<const ShadingPoint> points, std::size_t pixels,
                                 int count) const {
    return {points,
            options_.samples,
            static_cast<std::uint32_t>(pixels),
            static_cast<std::uint32_t>(count),
            options_.preview,
            plan_.estimator.get()};
}

void TileRenderer::meetBatch(std::span<const FilmPlace> places, int first, int count,
                             TileScratch& scratch, std::span<PixelSum> sums) const {
    sendCameraRays(places, first, count, scratch, sums);
    findPoints(scratch);
}

void TileRenderer::lightBatch(std::span<const FilmPlace> places, int first, int count,
                              TileScratch& scratch, Workspace& workspace,
                              std::span<PixelSum> sums) const {
    meetBatch(places, first, count, scratch, sums);
    const int most = std::ranges::max(sums, {}, &PixelSum::rayFactor).rayFactor * count;
    const PointBatch batch = batchOf(scratch.points, places.size(), most);
    workspace.watchedPixel.reset();
    workspace.watched.clear();
    for (std::size_t p = 0; observer_ && p < places.size(); ++p)
        if (places[p].x == observed_.x && places[p].y == observed_.y)
            workspace.watchedPixel = static_cast<std::uint32_t>(p);
    estimator_.estimate(batch, workspace, scratch.estimates);
    scratch.watched = workspace.watched;
    if (!scratch.glossyPoints.empty())
        estimator_.estimateGloss(batch, scratch.glossyPoints, workspace, scratch.glossEstimates);
}

void TileRenderer::addBatch(const TileScratch& scratch, Workspace& workspace,
                            std::span<PixelSum> sums) const {
    std::size_t i = 0;
    for (const TileScratch::Ray& ray : scratch.rays) {
        PixelSum& sum = sums[ray.pixel];
        ++sum.cameraRays;
        if (ray.view.hit.found) {
            addToPixel(scratch, i, ray, workspace, sum);
            ++i;
        } else {
            sum.sum.color += ray.sky;
            sum.sum.emission += ray.sky;
            sum.sum.environment += ray.sky;
            sum.sum.predicted += ray.sky;
            sum.color.add(static_cast<double>(context_.environment.luminance(ray.sky)), runLength_);
            sum.irradiance.add(0, runLength_);
        }
    }
}

void TileRenderer::sendCameraRays(std::span<const FilmPlace> places, int first, int count,
                                  TileScratch& scratch, std::span<PixelSum> sums) const {
    scratch.rays.clear();
    scratch.seeds.clear();
    for (std::size_t i = 0; i < places.size(); ++i) {
        const int factor = sums[i].rayFactor;
        aim(places[i], static_cast<std::uint32_t>(i),
            pixelSeed(options_.seed, number_, places[i].x, places[i].y, -1), first * factor,
            count * factor, scratch);
        scratch.seeds.push_back(pixelSeed(options_.seed, number_, places[i].x, places[i].y, 0));
    }
    intersect(scratch.rays);
    scratch.places.clear();
    for (TileScratch::Ray& ray : scratch.rays) {
        if (!ray.view.hit.found) {
            ray.sky = skyAlong(ray.view.direction);
            continue;
        }
        const SetPlace at = placeOf(ray.view);
        const Surface surface = surfaceOf(ray.view.hit, options_.plain);
        const Rgb albedo = diffuseAlbedo(surface, -at.normal.dot(ray.view.direction));
        const PixelSum& pixel = sums[ray.pixel];
        const BatchSlot slot{.seed = scratch.seeds[ray.pixel],
                             .filmX = places[ray.pixel].x,
                             .filmY = places[ray.pixel].y,
                             .cameraRay = static_cast<std::uint32_t>(ray.number),
                             .row = static_cast<std::uint32_t>(ray.row / pixel.rayFactor),
                             .pixel = ray.pixel,
                             .errorScale = irradianceScale(pixel.errorScale, albedo),
                             .sampleFraction = 1.0f / static_cast<float>(pixel.rayFactor)};
        scratch.places.push_back({.point = {at, slot},
                                  .surface = surface,
                                  .toViewer = surface.glossy ? -ray.view.direction : Vec3f(0, 0, 0),
                                  .diffuseAlbedo = albedo});
    }
}

void TileRenderer::findPoints(TileScratch& scratch) const {
    scratch.points.clear();
    scratch.glossyPoints.clear();
    for (TileScratch::Place& place : scratch.places) {
        const Surface& surface = place.surface;
        // Of a Lambertian surface the irradiance is told, however black it is.
        if (place.diffuseAlbedo != Rgb(0.0f) || !(surface.glossy || surface.unlit)) {
            place.diffuse = static_cast<std::uint32_t>(scratch.points.size());
            scratch.points.push_back(place.point);
        }
        if (surface.glossy) {
            place.glossy = static_cast<std::uint32_t>(scratch.glossyPoints.size());
            scratch.glossyPoints.push_back(
                {place.point, GlossyLobe(surface, place.point.place.normal, place.toViewer)});
        }
    }
    scratch.estimates.resize(scratch.points.size());
    scratch.glossEstimates.resize(scratch.glossyPoints.size());
}

void TileRenderer::addToPixel(const TileScratch& scratch, std::size_t number,
                              const TileScratch::Ray& ray, Workspace& workspace,
                              PixelSum& pixel) const {
    const TileScratch::Place& place = scratch.places[number];
    const ShadingPoint& point = place.point;
    const Surface& surface = place.surface;
    Estimate e = place.diffuse ? scratch.estimates[*place.diffuse] : Estimate{};
    GlossEstimate gloss = place.glossy ? scratch.glossEstimates[*place.glossy] : GlossEstimate{};
    const BouncedLight bounced = scratch.bounced.empty() ? BouncedLight{} : scratch.bounced[number];
    e.predicted *= 1 / bounced.exposure;
    if (options_.samples == 0) e.irradiance *= 1 / bounced.exposure;
    e.irradiance += bounced.irradiance;
    e.predicted += bounced.predicted;
    gloss.radiance += bounced.glossy;
    if (observer_ && point.slot.filmX == observed_.x && point.slot.filmY == observed_.y) {
        std::vector<Vec3f> directions;
        for (const WatchedSample& sample : scratch.watched)
            if (sample.cameraRay == point.slot.cameraRay) directions.push_back(sample.direction);
        (*observer_)({point, surface, e, gloss, directions});
    }
    const Rgb diffuse = place.diffuseAlbedo * e.irradiance * static_cast<float>(1 / kPi);
    const Rgb color = diffuse + gloss.radiance + surface.emission;
    Pixel& sum = pixel.sum;
    sum.color += color;
    sum.diffuse += diffuse;
    sum.diffuseIndirect += place.diffuseAlbedo * bounced.irradiance * static_cast<float>(1 / kPi);
    sum.glossy += gloss.radiance;
    sum.glossyIndirect += bounced.glossy;
    sum.emission += surface.emission;
    sum.predicted += place.diffuseAlbedo * e.predicted * static_cast<float>(1 / kPi) +
                     (gloss.radiance + surface.emission);
    sum.irradiance += e.irradiance;
    sum.albedo += surface.baseColor;
    sum.diffuseAlbedo += place.diffuseAlbedo;
    sum.mirrorColor += surface.glossy ? surface.f0 : Rgb(0, 0, 0);
    sum.roughness += surface.roughness;
    sum.normal += point.place.normal;
    sum.position += Vec3f(point.place.position);
    const double depth = static_cast<double>(ray.view.hit.distance) + ray.ray.skipped;
    sum.depth += static_cast<float>(depth);
    sum.axialDepth += static_cast<float>(depth * ray.ray.cosine);
    sum.variance += e.variance;
    sum.covariance += e.covariance;
    sum.glossVariance += gloss.variance;
    sum.rays += static_cast<float>(e.rays + e.reused + gloss.rays);
    sum.reusedRays += static_cast<float>(e.reused);
    const Environment& environment = context_.environment;
    pixel.color.add(static_cast<double>(environment.luminance(color)), runLength_);
    pixel.irradiance.add(static_cast<double>(environment.luminance(e.irradiance)), runLength_);
    ++pixel.hits;
    if (options_.insight && estimator_.insights())
        addInsight(estimator_.insights()->insight(point, options_.samples, plan_.estimator.get(),
                                                  workspace),
                   pixel);
}

void TileRenderer::renderTile(std::span<const FilmPlace> places, int cameraRays,
                              TileScratch& scratch, Workspace& workspace,
                              std::span<PixelSum> sums) const {
    for (int first = 0; first < cameraRays; first += options_.passRays)
        addCameraRays(places, first, std::min(options_.passRays, cameraRays - first), scratch,
                      workspace, sums);
}

Pixel TileRenderer::average(const PixelSum& sum) const {
    return averageOf(sum, runLength_, context_.environment.luminanceWeights());
}

void TileRenderer::observe(int x, int y, const CameraSampleObserver& observer) {
    observer_ = &observer;
    observed_ = {x, y};
}

}  // namespace shadowcache
