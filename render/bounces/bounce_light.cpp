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
    : estimator_(estimator), plan_(plan), options_(options) {}

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
    std::vector<PathLevel> levels{firstLevel(receivers, context.environment.luminanceWeights())};
    if (context.solve) startRare(receivers, levels.front());
    decideFirst(receivers, levels.front());
    std::vector<VertexGroups> groups;
    for (int bounce = 0; !levels.back().vertices.empty(); ++bounce) {
        throwIfInterrupted();
        PathLevel& level = levels.back();
        if (bounce > 0) {
            startWithIndirect(bouncesLeft(bounce), level);
            decide(bouncesLeft(bounce), level);
        }
        groups.push_back(groupVertices(level, sizesAt(bounce)));
        // Alone, a pixel's camera points have a sequence of their own.
        if (bounce > 0 || options_.shared) stratifyNumbers(groups.back(), level);
        if (bounce > 0) {
            counts.shadowRays +=
                lightVertices(estimator_, plan_, groups.back(), workspaces_, level);
            onLevel();
        }
        if (bouncesLeft(bounce) == 0) break;
        PathLevel next =
            nextLevel(context, options_.plain, groups.back().order, level, counts.pathRays);
        counts.vertices += next.vertices.size();
        levels.push_back(std::move(next));
    }
    while (levels.size() > 1) {
        throwIfInterrupted();
        const PathLevel next = std::move(levels.back());
        levels.pop_back();
        PathLevel& level = levels.back();
        const std::size_t bounce = levels.size() - 1;
        std::vector<Rgb> found(level.vertices.size());
        counts.sharedRays += exchange(context.scene, groups[bounce], level, next, found);
        addBounced(found, next, level);
    }
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        light[i].irradiance = levels.front().vertices[i].irradiance;
        light[i].glossy = levels.front().vertices[i].mirrored;
    }
    clampLight(receivers, light);
}

void BounceLight::startRare(std::span<const BounceReceiver> receivers, PathLevel& level) const {
    const EstimatorContext& context = estimator_.context();
    parallelFor(receivers.size(), kChunk, [&](const Chunk& chunk) {
        ShadowCache::Reader reader(*context.cache);
        std::array<ItemView, ShadowCache::kMaxItems> items;
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const ShadingPoint& point = *receivers[i].point;
            if (!receivers[i].diffuse || point.slot.sampleFraction >= 1) continue;
            const int found =
                reader.lookUp(point.place.position, point.place.geometricNormal, items);
            PathVertex& v = level.vertices[i];
            v.predicted = context.solve->indirect(
                std::span(items).first(static_cast<std::size_t>(found)), options_.most);
            v.irradiance = v.predicted;
        }
    });
}

void BounceLight::startWithIndirect(int bouncesLeft, PathLevel& level) const {
    const BounceSolve* solve = estimator_.context().solve;
    if (!solve) return;
    forEachIndex(level.vertices.size(), [&](std::size_t i) {
        PathVertex& v = level.vertices[i];
        if (v.item == kNoItem) return;
        v.predicted = solve->indirect(v.item, bouncesLeft);
        v.irradiance = v.predicted;
    });
}

void BounceLight::addBounced(std::span<const Rgb> found, const PathLevel& next,
                             PathLevel& level) const {
    forEachIndex(level.vertices.size(), [&](std::size_t i) {
        PathVertex& v = level.vertices[i];
        if (v.sendsDiffuse) {
            v.irradiance += (found[i] - v.predicted) * (1 / v.diffuseChance);
        }
        if (v.lobeChild == kNoVertex) return;
        const PathVertex& met = next.vertices[static_cast<std::size_t>(v.lobeChild)];
        v.mirrored += met.throughLobe * (met.diffuseRadiance() + met.mirrored) * (1 / v.lobeChance);
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
