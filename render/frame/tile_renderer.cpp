#include "render/frame/tile_renderer.h"

#include <algorithm>

#include "common/mesh/placed_mesh.h"
#include "common/random/sequence.h"

namespace shadowcache {

namespace {

/// Samples of a batch, at most, so that its memory is bounded for any number of samples.
constexpr int kBatchSamples = 1 << 21;

void addInsight(const CacheInsight& insight, Pixel& pixel) {
    pixel.openness += insight.openness;
    pixel.expectedNoise += insight.expectedNoise * insight.expectedNoise;
    pixel.items += static_cast<float>(insight.items);
    pixel.regions += static_cast<float>(insight.regions);
    pixel.misses += insight.items == 0 ? 1.0f : 0.0f;
}

int fewestRays(const FrameRequest& request) {
    return request.tileRays.empty() ? request.options.cameraRays
                                    : *std::ranges::min_element(request.tileRays);
}

}  // namespace

TileRenderer::TileRenderer(const FrameRequest& request)
    : estimator_(request.estimator),
      context_(estimator_.context()),
      camera_(request.camera),
      number_(request.number),
      options_(request.options),
      filter_(options_.filter, options_.filterWidth),
      runLength_(spreadRunLength(std::min(fewestRays(request), options_.passRays))) {}

View TileRenderer::look(double filmX, double filmY) const {
    const double aspect = static_cast<double>(options_.width) / options_.height;
    const Vec3f origin(rayStart(camera_, filmX, filmY, aspect) - context_.scene.mesh().origin);
    const Vec3f direction(rayDirection(camera_, filmX, filmY, aspect));
    return {direction, context_.scene.intersect(origin, direction)};
}

ShadingPoint TileRenderer::shadingPoint(const View& view, std::uint64_t seed, int filmX,
                                        int filmY) const {
    const Hit& hit = view.hit;
    const Vec3f normal = hit.normal.dot(view.direction) > 0 ? -hit.normal : hit.normal;
    return {hit.scene->rayOrigin(hit.position, hit.triangle, normal),
            context_.scene.mesh().origin + Vec3d(hit.position),
            normal,
            seed,
            filmX,
            filmY};
}

View TileRenderer::lookThrough(const FilmPlace& place, int cameraRay) const {
    double dx = 0, dy = 0;
    if (options_.cameraRays > 1) {
        std::uint32_t u = 0, v = 0;
        const std::uint64_t film = pixelSeed(options_.seed, number_, place.x, place.y, -1);
        owenSobol(static_cast<std::uint32_t>(cameraRay), 0, film, {&u, 1});
        owenSobol(static_cast<std::uint32_t>(cameraRay), 1, film, {&v, 1});
        dx = filter_.offset(static_cast<double>(toUnitFloat(u)));
        dy = filter_.offset(static_cast<double>(toUnitFloat(v)));
    }
    return look((place.x + (0.5 + dx)) / options_.width, (place.y + (0.5 + dy)) / options_.height);
}

void TileRenderer::addCameraRays(std::span<const FilmPlace> places, int first, int count,
                                 TileScratch& scratch, Workspace& workspace,
                                 std::span<PixelSum> sums) const {
    const int samples = std::max(1, options_.samples);
    const auto run = static_cast<std::size_t>(std::max(1, kBatchSamples / samples));
    for (std::size_t p = 0; p < places.size(); p += run) {
        const std::size_t pixels = std::min(run, places.size() - p);
        const int rays = std::clamp(static_cast<int>(run / pixels), 1, options_.passRays);
        for (int k = first; k < first + count; k += rays)
            addBatch(places.subspan(p, pixels), k, std::min(rays, first + count - k), scratch,
                     workspace, sums.subspan(p, pixels));
    }
}

PointBatch TileRenderer::batchOf(std::span<const ShadingPoint> points, std::size_t pixels,
                                 int first, int count) const {
    return {points,
            options_.samples,
            static_cast<std::uint32_t>(pixels),
            static_cast<std::uint32_t>(count),
            static_cast<std::uint32_t>(first),
            static_cast<std::uint32_t>(options_.cameraRays) *
                static_cast<std::uint32_t>(options_.samples)};
}

void TileRenderer::addBatch(std::span<const FilmPlace> places, int first, int count,
                            TileScratch& scratch, Workspace& workspace,
                            std::span<PixelSum> sums) const {
    sendCameraRays(places, first, count, scratch, sums);
    scratch.estimates.resize(scratch.points.size());
    const PointBatch batch = batchOf(scratch.points, places.size(), first, count);
    workspace.watchedPixel.reset();
    workspace.watched.clear();
    for (std::size_t p = 0; observer_ && p < places.size(); ++p)
        if (places[p].x == observed_.x && places[p].y == observed_.y)
            workspace.watchedPixel = static_cast<std::uint32_t>(p);
    estimator_.estimate(batch, workspace, scratch.estimates);
    std::size_t i = 0;
    for (const TileScratch::Ray& ray : scratch.rays) {
        PixelSum& sum = sums[ray.pixel];
        ++sum.cameraRays;
        if (ray.hit.found) {
            addToPixel(scratch.points[i], ray.hit, scratch.estimates[i], workspace, sum);
            ++i;
        } else {
            sum.color.add(ray.skyLuminance, runLength_);
            sum.irradiance.add(0, runLength_);
        }
    }
}

void TileRenderer::sendCameraRays(std::span<const FilmPlace> places, int first, int count,
                                  TileScratch& scratch, std::span<PixelSum> sums) const {
    scratch.points.clear();
    scratch.rays.clear();
    for (std::size_t i = 0; i < places.size(); ++i) {
        const auto [x, y] = places[i];
        const auto pixel = static_cast<std::uint32_t>(i);
        const std::uint64_t seed = pixelSeed(options_.seed, number_, x, y, 0);
        for (int k = first; k < first + count; ++k) {
            const View view = lookThrough(places[i], k);
            TileScratch::Ray& ray = scratch.rays.emplace_back(pixel, view.hit, 0.0);
            if (!view.hit.found) {
                const Rgb radiance = context_.environment.radiance(view.direction);
                ray.skyLuminance = static_cast<double>(context_.environment.luminance(radiance));
                sums[i].sum.color += radiance;
                continue;
            }
            ShadingPoint& point = scratch.points.emplace_back(shadingPoint(view, seed, x, y));
            point.cameraRay = static_cast<std::uint32_t>(k);
            point.pixel = pixel;
        }
    }
}

void TileRenderer::addToPixel(const ShadingPoint& point, const Hit& hit, const Estimate& e,
                              Workspace& workspace, PixelSum& pixel) const {
    const TriangleMesh& mesh = hit.scene->mesh();
    const Rgb albedo =
        albedoAt(mesh, placedTriangle(mesh, hit.triangle).triangle, hit.u, hit.v, options_.albedo);
    if (observer_ && point.filmX == observed_.x && point.filmY == observed_.y) {
        std::vector<Vec3f> directions;
        for (const WatchedSample& sample : workspace.watched)
            if (sample.cameraRay == point.cameraRay) directions.push_back(sample.direction);
        (*observer_)({point, albedo, e, directions});
    }
    const Rgb color = albedo * e.irradiance * static_cast<float>(1 / kPi);
    Pixel& sum = pixel.sum;
    sum.color += color;
    sum.irradiance += e.irradiance;
    sum.albedo += albedo;
    sum.normal += point.normal;
    sum.position += Vec3f(point.position);
    sum.depth += hit.distance;
    sum.variance += e.variance;
    sum.rays += static_cast<float>(e.rays + e.reused);
    sum.reusedRays += static_cast<float>(e.reused);
    const Environment& environment = context_.environment;
    pixel.color.add(static_cast<double>(environment.luminance(color)), runLength_);
    pixel.irradiance.add(static_cast<double>(environment.luminance(e.irradiance)), runLength_);
    if (options_.insight && estimator_.insights())
        addInsight(estimator_.insights()->insight(point, options_.samples, workspace), sum);
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
