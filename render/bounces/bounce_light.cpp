#include "render/bounces/bounce_light.h"

#include <algorithm>
#include <array>
#include <utility>

#include "common/base/parallel.h"
#include "common/base/progress.h"
#include "common/base/tuned.h"
#include "common/predict/grouped_solve.h"
#include "render/bounces/exchange.h"
#include "render/bounces/mirrored_sky.h"
#include "render/bounces/path_steps.h"
#include "render/bounces/russian_roulette.h"
#include "render/bounces/vertex_items.h"
#include "render/bounces/vertex_light.h"
#include "render/estimators/light_groups.h"

namespace shadowcache {

namespace {

/// Camera points that share what their rays meet, each of another pixel: a pixel gains from as many
/// groups as it has camera rays.
SHADOWCACHE_TUNED(std::size_t, kPointGroup, 64);

/// Vertices of paths that do. They are farther from each other.
SHADOWCACHE_TUNED(std::size_t, kVertexGroup, 8);

/// Groups of vertices that have one sequence of directions, about.
SHADOWCACHE_TUNED(std::size_t, kGroupsOfCluster, 4);

/// Neighbouring clusters of vertices of paths that have one guide: few rays tell where all of them
/// are lit from.
SHADOWCACHE_TUNED(std::size_t, kClustersOfGuide, 64);

/// Vertices that a thread takes at a time.
constexpr std::size_t kReceiverChunk = 4096;

template <class Body>
void forEachIndex(std::size_t count, const Body& body) {
    parallelFor(count, kReceiverChunk, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) body(i);
    });
}

/// Has light by group be what is predicted.
void takePredicted(GroupedVertexLight& light, std::size_t number) {
    std::ranges::copy(light.predicted[number], light.irradiance[number].begin());
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
    return {kPointGroup, static_cast<std::size_t>(options_.raysOfPixel), true};
}

GroupedBounce BounceLight::gather(std::span<const BounceReceiver> receivers,
                                  std::span<BouncedLight> light, BounceCounts& counts,
                                  const std::function<void()>& onLevel, PathPilot* pilot) const {
    const EstimatorContext& context = estimator_.context();
    std::vector<PathLevel> levels;
    PathVertices vertices = firstVertices(receivers, context.environment.luminanceWeights());
    for (int bounce = 0; !vertices.vertices.empty(); ++bounce) {
        throwIfInterrupted();
        PathLevel& level = levels.emplace_back();
        level.at = std::move(vertices);
        addGroups(level);
        level.light.resize(level.size());
        if (bounce > 0) predictLight(bounce, level);
        level.choices = bounce == 0 ? chooseFirst(receivers)
                                    : choose(level, bouncesLeft(bounce), options_.trust,
                                             context.environment.luminanceWeights());
        level.groups = groupVertices(level.at.vertices, level.choices, sizesAt(bounce));
        if (bounce > 0) {
            if (pilot) addLit(level, *pilot);
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
        if (bounce == 0 && options_.shared) shareMirroredSky(context, vertices);
        counts.pathRays += step.rays;
        counts.vertices += vertices.vertices.size();
    }
    PathLevel next;  // beyond the last: nothing
    for (; !levels.empty(); levels.pop_back()) {
        throwIfInterrupted();
        PathLevel& level = levels.back();
        if (!level.children.empty()) {
            GroupedLight grouped;
            if (context.groups) grouped.assign(level.size(), context.groups->size());
            const std::vector<Rgb> found =
                exchange(context, level, next, counts.sharedRays, grouped);
            if (pilot) comparePredicted(level, found, pilot->check);
            addBounced(found, next, level);
            if (context.groups) addBounced(grouped, next, level);
        }
        next = std::move(level);
    }
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        light[i].irradiance = next.light[i].irradiance;
        light[i].glossy = next.light[i].mirrored;
    }
    GroupedBounce grouped{std::move(next.groupedLight.irradiance),
                          std::move(next.groupedLight.mirrored)};
    clampLight(receivers, light, grouped);
    return grouped;
}

void BounceLight::addLit(const PathLevel& level, PathPilot& pilot) const {
    for (std::size_t i = 0; i < level.size(); ++i)
        if (level.choices[i].isLit)
            pilot.vertices.push_back(shadingPointOf(estimator_.context(), level.at.vertices[i]));
}

Guides BounceLight::guide(const PathLevel& level, int bounce, BounceCounts& counts) const {
    const EstimatorContext& context = estimator_.context();
    if (!options_.shared || !context.radiosity) return {};
    return Guides::ofClusters(context, level.at.vertices, level.groups,
                              bounce == 0 ? 1 : kClustersOfGuide, counts.pathRays);
}

void BounceLight::addGroups(PathLevel& level) const {
    const LightGroups* groups = estimator_.context().groups;
    if (!groups) return;
    level.groupedLight.predicted.assign(level.size(), groups->size());
    level.groupedLight.irradiance.assign(level.size(), groups->size());
    if (!level.at.lobes.empty()) level.groupedLight.mirrored.assign(level.size(), groups->size());
}

void BounceLight::predictLight(int bounce, PathLevel& level) const {
    const EstimatorContext& context = estimator_.context();
    if (!context.solve || !(options_.trust > 0)) return;
    forEachIndex(level.size(), [&](std::size_t i) {
        const std::uint32_t item = level.at.vertices[i].item;
        if (item == kNoItem) return;
        level.light[i] =
            VertexLight::of(context.solve->indirect(item, bouncesLeft(bounce)) * options_.trust);
        if (!context.groupedSolve) return;
        const std::span<Rgb> ofGroups = level.groupedLight.predicted[i];
        context.groupedSolve->indirect(item, bouncesLeft(bounce), ofGroups);
        for (Rgb& light : ofGroups) light *= options_.trust;
        takePredicted(level.groupedLight, i);
    });
}

void BounceLight::comparePredicted(const PathLevel& level, std::span<const Rgb> found,
                                   PredictionCheck& check) const {
    const Rgb weights = estimator_.context().environment.luminanceWeights();
    for (std::size_t i = 0; i < level.size(); ++i) {
        if (!level.choices[i].sendsDiffuse) continue;
        const PathVertex& v = level.at.vertices[i];
        check.add(static_cast<double>(partOfPixel(v, level.light[i].predicted, weights)),
                  static_cast<double>(partOfPixel(v, found[i], weights)));
    }
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

void BounceLight::addBounced(const GroupedLight& found, const PathLevel& next,
                             PathLevel& level) const {
    GroupedVertexLight& light = level.groupedLight;
    forEachIndex(level.size(), [&](std::size_t i) {
        const VertexChoice& choice = level.choices[i];
        for (std::size_t g = 0; choice.sendsDiffuse && g < found.groups(); ++g)
            light.irradiance[i][g] +=
                (found[i][g] - light.predicted[i][g]) * (1 / choice.diffuseChance);
        if (level.children[i].lobe == VertexChildren::kNone) return;
        const auto child = static_cast<std::size_t>(level.children[i].lobe);
        const PathVertex& met = next.at.vertices[child];
        const GroupedVertexLight& there = next.groupedLight;
        for (std::size_t g = 0; g < found.groups(); ++g) {
            Rgb radiance = diffuseRadiance(met, g, there.irradiance[child][g]);
            if (!there.mirrored.empty()) radiance += there.mirrored[child][g];
            light.mirrored[i][g] += met.throughLobe * radiance * (1 / choice.lobeChance);
        }
    });
}

GroupedBounce BounceLight::predict(std::span<const BounceReceiver> receivers,
                                   std::span<BouncedLight> light) const {
    const EstimatorContext& context = estimator_.context();
    GroupedBounce grouped;
    if (context.groups) grouped.irradiance.assign(receivers.size(), context.groups->size());
    if (!context.solve) return grouped;
    parallelFor(receivers.size(), kReceiverChunk, [&](const Chunk& chunk) {
        ShadowCache::Reader reader(*context.cache);
        std::array<ItemView, ShadowCache::kMaxItems> items;
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const ShadingPoint& point = *receivers[i].point;
            const int found =
                reader.lookUp(point.place.position, point.place.geometricNormal, items);
            const auto near = std::span(items).first(static_cast<std::size_t>(found));
            light[i].predicted = context.solve->indirect(near, options_.most);
            light[i].exposure = context.solve->exposure(near);
            if (context.groupedSolve)
                context.groupedSolve->indirect(near, options_.most, grouped.irradiance[i]);
        }
    });
    return grouped;
}

void BounceLight::clampLight(std::span<const BounceReceiver> receivers,
                             std::span<BouncedLight> light, GroupedBounce& grouped) const {
    if (!(options_.clamp > 0)) return;
    const Environment& environment = estimator_.context().environment;
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        const Rgb radiance =
            receivers[i].diffuseAlbedo * light[i].irradiance * static_cast<float>(1 / kPi) +
            light[i].glossy;
        const float luminance = environment.luminance(radiance);
        if (!(luminance > options_.clamp)) continue;
        const float factor = options_.clamp / luminance;
        light[i].irradiance *= factor;
        light[i].glossy *= factor;
        for (GroupedLight* each : {&grouped.irradiance, &grouped.glossy})
            if (!each->empty())
                for (Rgb& ofGroup : (*each)[i]) ofGroup *= factor;
    }
}

}  // namespace shadowcache
