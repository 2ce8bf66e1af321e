#include "render/frame/film_rays.h"

#include <algorithm>
#include <array>
#include <bit>

#include "common/random/salts.h"
#include "common/random/sequence.h"
#include "render/frame/pixel_sum.h"

namespace shadowcache {

namespace {

/// Part of a pixel's rays that show panes at least: none where a run of rays, by which their spread
/// is measured, would not have one; nor where tiles have numbers of their own.
float leastOfPanes(const FrameRequest& frame) {
    if (!frame.tileRays.empty()) return 0;
    const int pass = std::min(frame.options.cameraRays, frame.options.passRays);
    return static_cast<float>(spreadRunLength(pass)) * kLeastOfPanes >= 1 ? kLeastOfPanes : 0;
}

}  // namespace

FilmRays::FilmRays(const FrameRequest& frame)
    : scene_(frame.estimator.context().scene),
      camera_(frame.camera, static_cast<double>(frame.options.width) / frame.options.height),
      number_(frame.number),
      options_(frame.options),
      filter_(options_.filter, options_.filterWidth),
      leastOfPanes_(leastOfPanes(frame)) {}

FilmRay FilmRays::look(const FilmPosition& at) const {
    const CameraRay ray = camera_.through(at);
    const std::uint64_t hash =
        hashWords(std::bit_cast<std::uint64_t>(at.x), std::bit_cast<std::uint64_t>(at.y));
    const float chance = toUnitFloat(static_cast<std::uint32_t>(hash));
    return {.ray = ray, .view = lookAlong(ray, scene_, chance), .chance = chance};
}

std::optional<FilmPosition> FilmRays::project(const Vec3f& point) const {
    return camera_.project(scene_.mesh().origin + Vec3d(point));
}

std::vector<FilmRay> FilmRays::cast(const BatchPixels& batch) const {
    std::vector<FilmRay> rays;
    for (std::uint32_t i = 0; i < batch.places.size(); ++i) {
        const auto [x, y] = batch.places[i];
        const int factor = batch.rates[i].rayFactor;
        aim(batch.places[i], i, pixelSeed(options_.seed, number_, x, y, -1),
            {batch.rays.first * factor, batch.rays.count * factor}, rays);
    }
    intersect(rays, leastOfPanes_);
    return rays;
}

std::vector<FilmRay> FilmRays::castExtra(std::span<const FilmPlace> places, int count) const {
    std::vector<FilmRay> rays;
    for (std::uint32_t i = 0; i < places.size(); ++i) {
        const auto [x, y] = places[i];
        aim(places[i], i,
            hashWords(pixelSeed(options_.seed, number_, x, y, -1), RenderSalt::spreadRays),
            {0, count}, rays);
    }
    // What they are for tells apart what pixels show, not how often.
    intersect(rays, 0);
    return rays;
}

std::vector<FilmRay> FilmRays::castEmission(const FilmPlace& place, RayRange range) const {
    std::vector<FilmRay> rays;
    aim(place, 0,
        hashWords(pixelSeed(options_.seed, number_, place.x, place.y, -1),
                  RenderSalt::emissionRays),
        range, rays);
    intersect(rays, leastOfPanes_);
    return rays;
}

/// A pixel's rays are points of one Sobol' sequence: on the film, on the lens, in time, and of what
/// they may pass.
void FilmRays::aim(const FilmPlace& place, std::uint32_t pixel, std::uint64_t seed, RayRange range,
                   std::vector<FilmRay>& rays) const {
    std::array<std::vector<std::uint32_t>, 6> words;
    const auto draw = [&](std::size_t word, int dimension, std::uint64_t sequence) {
        words[word].resize(static_cast<std::size_t>(range.count));
        owenSobol(static_cast<std::uint32_t>(range.first), dimension, sequence, words[word]);
    };
    const auto number = [&](std::size_t word, int k) {
        return static_cast<double>(toUnitFloat(words[word][static_cast<std::size_t>(k)]));
    };
    const bool centered = options_.cameraRays == 1;
    if (!centered)
        for (const int d : {0, 1}) draw(static_cast<std::size_t>(d), d, seed);
    if (camera_.spread()) {
        for (const int d : {2, 3}) draw(static_cast<std::size_t>(d), d, seed);
        draw(4, 0, hashWords(seed, RenderSalt::shutterTime));
    }
    draw(5, 0, hashWords(seed, RenderSalt::crossing));
    for (int k = 0; k < range.count; ++k) {
        const double dx = centered ? 0 : filter_.offset(number(0, k));
        const double dy = centered ? 0 : filter_.offset(number(1, k));
        const FilmPosition at{(place.x + (0.5 + dx)) / options_.width,
                              (place.y + (0.5 + dy)) / options_.height};
        const CameraRay ray = camera_.spread()
                                  ? camera_.through(at, {number(2, k), number(3, k), number(4, k)})
                                  : camera_.through(at);
        rays.push_back({pixel,
                        range.first + k,
                        ray,
                        {Vec3f(ray.direction), {}},
                        toUnitFloat(words[5][static_cast<std::size_t>(k)])});
    }
}

/// Neighbours together, in packets.
void FilmRays::intersect(std::span<FilmRay> rays, float leastOfPanes) const {
    constexpr auto kSize = static_cast<std::size_t>(RayPacket::kSize);
    CameraPacket packet{};
    std::array<Hit, kSize> hits;
    for (std::size_t first = 0; first < rays.size(); first += kSize) {
        const auto some = rays.subspan(first, std::min(kSize, rays.size() - first));
        const auto count = static_cast<int>(some.size());
        for (int i = 0; i < count; ++i) {
            const FilmRay& ray = some[static_cast<std::size_t>(i)];
            packet.set(i, startIn(scene_, ray.ray), ray.view.direction, ray.chance, ray.ray.reach);
        }
        scene_.look(packet, count, leastOfPanes, hits.data());
        for (std::size_t i = 0; i < some.size(); ++i) some[i].view.hit = hits[i];
    }
}

}  // namespace shadowcache
