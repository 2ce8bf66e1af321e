#include "render/bounces/bounce_light.h"

#include <algorithm>
#include <array>

#include "common/base/parallel.h"
#include "common/base/progress.h"
#include "common/base/tuned.h"
#include "render/bounces/exchange.h"
#include "render/bounces/path_steps.h"
#include "render/bounces/russian_roulette.h"
#include "render/bounces/vertex_items.h"
#include "render/bounces/vertex_light.h"

namespace shadowcache {

namespace {

/// Camera points that share what their rays meet, each of another pixel: a pixel gains from as many
/// groups as it has camera rays.
SHADOWCACHE_TUNED(std::size_t, kPointGroup, 32);

/// Rays of others that a pixel shares at least: groups are larger where it has few camera rays.
SHADOWCACHE_TUNED(std::size_t, kPixelHits, 64);

/// Vertices of paths that do. They are farther from each other.
SHADOWCACHE_TUNED(std::size_t, kVertexGroup, 8);

/// Groups of vertices that have one sequence of directions, about.
SHADOWCACHE_TUNED(std::size_t, kGroupsOfCluster, 4);

/// Vertices that a thread takes at a time.
constexpr std::size_t kChunk = 4096;

template <class Body>
void forEachIndex(std::size_t count, const Body& body) {
    parallelFor(count, kChunk, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) body(i);
    });
}

}  // namespace

BounceLight::BounceLight(const Estimator& estimator, const EstimatorPlan* plan,
                         const BounceOptions& options)
    : estimator_(estimator),
      plan_(plan),
      options_(options),
      itemGuides_(estimator.context()) {}

int BounceLight::bouncesLeft(int bounce) const {
    return options_.most == kUnlimitedBounces ? kUnlimitedBounces : options_.most - bounce;
}

GroupSizes BounceLight::sizesAt(int bounce) const {
    if (!options_.shared) return {1, 1, false};
    if (bounce > 0) return {kVertexGroup, kGroupsOfCluster, false};
    const auto rays = static_cast<std::size_t>(options_.raysOfPixel);
    return {std::max(kPointGroup, kPixelHits / rays), rays, true};
}

void BounceLight::gather(std::span<const BounceReceiver> receivers, std::span<BouncedLight> light,
                         BounceCounts& counts, const std::function<void()>& onLevel) const {
    const EstimatorContext& context = estimator_.context();
    std::vector<PathLevel> levels;
    PathVertices vertices = firstVertices(receivers, context.environment.luminanceWeights());
    for (int bounce = 0; !vertices.vertices.empty(); ++bounce) {
        throwIfInterrupted();
        PathLevel& level = levels.emplace_back();
        level.at = std::move(vertices);
        level.light = bounce == 0 ? predictFirst(receivers) : predictLight(level.at, bounce);
        level.choices =
            bounce == 0 ? chooseFirst(receivers) : choose(level.at, bouncesLeft(bounce));
        level.groups = groupVertices(level.at.vertices, level.choices, sizesAt(bounce));
        if (bounce > 0) {
            counts.shadowRays += lightVertices(estimator_, plan_, workspaces_, level);
            onLevel();
        }
        if (bouncesLeft(bounce) == 0) break;
        // Alone, a pixel's camera points have a sequence of their own.
        const DirectionNumbers numbers = bounce > 0 || options_.shared
                                             ? stratifiedNumbers(level.at.vertices, level.groups)
                                             : firstNumbers(receivers);
        level.guides = guide(level, bounce, counts);
        PathStep step = nextVertices(context, options_.plain, level, numbers);
        level.children = std::move(step.children);
        vertices = std::move(step.next);
        counts.pathRays += step.rays;
        counts.vertices += vertices.vertices.size();
    }
    PathLevel next;  // beyond the last: nothing
    for (; !levels.empty(); levels.pop_back()) {
        throwIfInterrupted();
        PathLevel& level = levels.back();
        if (!level.children.empty())
            addBounced(exchange(context.scene, level, next, counts.sharedRays), next, level);
        next = std::move(level);
    }
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        light[i].irradiance = next.light[i].irradiance;
        light[i].glossy = next.light[i].mirrored;
    }
    clampLight(receivers, light);
}

Guides BounceLight::guide(const PathLevel& level, int bounce, BounceCounts& counts) const {
    const EstimatorContext& context = estimator_.context();
    if (!options_.shared || !context.radiosity) return {};
    return bounce == 0
               ? Guides::ofClusters(context, level.at.vertices, level.groups, counts.pathRays)
               : Guides::ofItems(itemGuides_, level.at.vertices, level.groups);
}

std::vector<VertexLight> BounceLight::predictFirst(
    std::span<const BounceReceiver> receivers) const {
    const EstimatorContext& context = estimator_.context();
    std::vector<VertexLight> light(receivers.size());
    if (!context.solve) return light;
    parallelFor(receivers.size(), kChunk, [&](const Chunk& chunk) {
        ShadowCache::Reader reader(*context.cache);
        std::array<ItemView, ShadowCache::kMaxItems> items;
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const auto& [place, slot] = *receivers[i].point;
            if (!receivers[i].diffuse || slot.sampleFraction >= 1) continue;
            const int found = reader.lookUp(place.position, place.geometricNormal, items);
            light[i] = VertexLight::of(context.solve->indirect(
                std::span(items).first(static_cast<std::size_t>(found)), options_.most));
        }
    });
    return light;
}

std::vector<VertexLight> BounceLight::predictLight(const PathVertices& level, int bounce) const {
    const BounceSolve* solve = estimator_.context().solve;
    std::vector<VertexLight> light(level.vertices.size());
    if (!solve) return light;
    forEachIndex(light.size(), [&](std::size_t i) {
        const std::uint32_t item = level.vertices[i].item;
        if (item != kNoItem) light[i] = VertexLight::of(solve->indirect(item, bouncesLeft(bounce)));
    });
    return light;
}

void BounceLight::addBounced(std::span<const Rgb> found, const PathLevel& next,
                             PathLevel& level) const {
    forEachIndex(level.size(), [&](std::size_t i) {
        const VertexChoice& choice = level.choices[i];
        VertexLight& light = level.light[i];
        if (choice.sendsDiffuse)
            light.irradiance += (found[i] - light.predicted) * (1 / choice.diffuseChance);
        if (level.children[i].lobe == VertexChildren::kNone) return;
        const auto child = static_cast<std::size_t>(level.children[i].lobe);
        const PathVertex& met = next.at.vertices[child];
        const VertexLight& there = next.light[child];
        light.mirrored += met.throughLobe * (diffuseRadiance(met, there) + there.mirrored) *
                          (1 / choice.lobeChance);
    });
}

void BounceLight::predict(std::span<const BounceReceiver> receivers,
                          std::span<BouncedLight> light) const {
    const EstimatorContext& context = estimator_.context();
    if (!context.solve) return;
    parallelFor(receivers.size(), kChunk, [&](const Chunk& chunk) {
        ShadowCache::Reader reader(*context.cache);
        std::array<ItemView, ShadowCache::kMaxItems> items;
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const ShadingPoint& point = *receivers[i].point;
            const int found =
                reader.lookUp(point.place.position, point.place.geometricNormal, items);
            const auto near = std::span(items).first(static_cast<std::size_t>(found));
            light[i].predicted = context.solve->indirect(near, options_.most);
            light[i].exposure = context.solve->exposure(near);
        }
    });
}

void BounceLight::clampLight(std::span<const BounceReceiver> receivers,
                             std::span<BouncedLight> light) const {
    if (!(options_.clamp > 0)) return;
    const Environment& environment = estimator_.context().environment;
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        const Rgb radiance =
            receivers[i].diffuseAlbedo * light[i].irradiance * static_cast<float>(1 / kPi) +
            light[i].glossy;
        const float luminance = environment.luminance(radiance);
        if (!(luminance > options_.clamp)) continue;
        light[i].irradiance *= options_.clamp / luminance;
        light[i].glossy *= options_.clamp / luminance;
    }
}

}  // namespace shadowcache
