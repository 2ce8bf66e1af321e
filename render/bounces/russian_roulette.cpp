#include "render/bounces/russian_roulette.h"

#include <algorithm>
#include <cmath>

#include "common/base/hash.h"
#include "common/base/parallel.h"
#include "common/base/tuned.h"
#include "common/random/salts.h"

namespace shadowcache {

namespace {

/// Least chance that a vertex sends a diffuse ray where its irradiance is predicted.
SHADOWCACHE_TUNED(float, kBounceChance, 0.6f);

/// Least and, of paths without end, highest chance by Russian roulette.
constexpr float kLeastChance = 0.05f, kMostChance = 0.99f;

/// Vertices that a thread takes at a time.
constexpr std::size_t kChunk = 4096;

float highest(const Rgb& color) {
    return std::max({color.x, color.y, color.z});
}

/// Whether a camera ray is the one of its run that sends.
bool isSender(const ShadingPoint& point, std::uint32_t run) {
    const std::uint64_t drawn =
        hashWords(point.slot.seed, RenderSalt::bounceSender, point.slot.cameraRay / run) % run;
    return point.slot.cameraRay % run == drawn;
}

float roulette(float reflectance, bool unlimited) {
    return std::clamp(reflectance, kLeastChance, unlimited ? kMostChance : 1.0f);
}

}  // namespace

float chanceOf(const PathVertex& vertex, std::uint64_t choice) {
    return static_cast<float>(toUnit(hashWords(vertex.seed, RenderSalt::bounceSends, choice)));
}

LobeRay lobeRayOf(const PathVertex& vertex, const GlossyLobe& lobe) {
    const auto number = [&](std::uint64_t dimension) {
        // Rounding must not reach 1.
        return static_cast<float>(
                   toUnit(hashWords(vertex.seed, RenderSalt::bounceLobe, dimension))) *
               0x1.fffffep-1f;
    };
    LobeRay ray;
    ray.direction = lobe.sample(number(0), number(1));
    const float density = lobe.density(ray.direction);
    if (density > 0 && ray.direction.dot(vertex.geometricNormal) > 0)
        ray.share = lobe.value(ray.direction) * (1 / density);
    return ray;
}

void decideFirst(std::span<const BounceReceiver> receivers, PathLevel& level) {
    parallelFor(level.vertices.size(), kChunk, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const ShadingPoint& point = *receivers[i].point;
            PathVertex& v = level.vertices[i];
            const auto run = static_cast<std::uint32_t>(std::lround(1 / point.slot.sampleFraction));
            const bool sends = isSender(point, run);
            if (receivers[i].diffuse) {
                v.diffuseChance = point.slot.sampleFraction;
                v.sendsDiffuse = sends;
            }
            if (v.lobe < 0) continue;
            v.lobeChance = point.slot.sampleFraction;
            v.sendsLobe = sends;
        }
    });
}

void decide(int bouncesLeft, PathLevel& level) {
    const bool unlimited = bouncesLeft == kUnlimitedBounces;
    parallelFor(level.vertices.size(), kChunk, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            PathVertex& v = level.vertices[i];
            const float reflectance = highest(v.albedo);
            if (reflectance <= 0 && v.lobe < 0) continue;
            v.isLit = true;
            if (bouncesLeft == 0) continue;
            // With a chance q, the second moment of what paths correct grows by albedo^2 / q a
            // bounce in a closed room: q must not be below the albedo.
            if (reflectance > 0)
                v.diffuseChance = std::max(v.item != kNoItem ? kBounceChance : 0.0f,
                                           roulette(reflectance, unlimited));
            v.sendsDiffuse = chanceOf(v, 1) < v.diffuseChance;
            if (v.lobe < 0) continue;
            const LobeRay ray = lobeRayOf(v, level.lobes[static_cast<std::size_t>(v.lobe)]);
            if (ray.share != Rgb(0, 0, 0)) v.lobeChance = roulette(highest(ray.share), unlimited);
            v.sendsLobe = chanceOf(v, 2) < v.lobeChance;
        }
    });
}

}  // namespace shadowcache
