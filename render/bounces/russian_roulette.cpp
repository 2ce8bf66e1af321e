#include "render/bounces/russian_roulette.h"

#include <algorithm>
#include <cmath>

#include "common/base/hash.h"
#include "common/base/parallel.h"
#include "common/base/tuned.h"
#include "common/random/salts.h"

namespace shadowcache {

namespace {

/// Least chance that a vertex sends a diffuse ray where its irradiance is predicted, the prediction
/// is fully trusted, and the pixel shows much of it.
SHADOWCACHE_TUNED(float, kBounceChance, 0.85f);

/// Part of the brightness of a pixel from which on what a vertex adds to it is much.
SHADOWCACHE_TUNED(float, kMuchOfPixel, 0.25f);

/// Least and, of paths without end, highest chance by Russian roulette.
constexpr float kLeastChance = 0.05f, kMostChance = 0.99f;

/// Vertices that a thread takes at a time.
constexpr std::size_t kRouletteChunk = 4096;

float highest(const Rgb& color) {
    return std::max({color.x, color.y, color.z});
}

/// Whether a camera ray is the one of its run that sends.
bool isSender(const BatchSlot& slot, std::uint32_t run) {
    const std::uint64_t drawn =
        hashWords(slot.seed, RenderSalt::bounceSender, slot.cameraRay / run) % run;
    return slot.cameraRay % run == drawn;
}

/// Number in [0, 1) that decides a choice of a vertex; choices have numbers of their own.
float chanceOf(const PathVertex& vertex, std::uint64_t choice) {
    return static_cast<float>(toUnit(hashWords(vertex.seed, RenderSalt::bounceSends, choice)));
}

float roulette(float reflectance, bool unlimited) {
    return std::clamp(reflectance, kLeastChance, unlimited ? kMostChance : 1.0f);
}

}  // namespace

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

std::vector<VertexChoice> chooseFirst(std::span<const BounceReceiver> receivers) {
    std::vector<VertexChoice> choices(receivers.size());
    parallelFor(receivers.size(), kRouletteChunk, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const BatchSlot& slot = receivers[i].point->slot;
            VertexChoice& choice = choices[i];
            const auto run = static_cast<std::uint32_t>(std::lround(1 / slot.sampleFraction));
            const bool sends = isSender(slot, run);
            if (receivers[i].diffuse) {
                choice.diffuseChance = slot.sampleFraction;
                choice.sendsDiffuse = sends;
            }
            if (!receivers[i].lobe) continue;
            choice.lobeChance = slot.sampleFraction;
            choice.sendsLobe = sends;
        }
    });
    return choices;
}

std::vector<VertexChoice> choose(const PathLevel& level, int bouncesLeft, float trust,
                                 const Rgb& luminanceWeights) {
    const bool unlimited = bouncesLeft == kUnlimitedBounces;
    std::vector<VertexChoice> choices(level.size());
    // What paths correct is as much as is predicted. By the square root, since predictions are at
    // times far too low.
    const auto chanceToCorrect = [&](std::size_t i) {
        const PathVertex& v = level.at.vertices[i];
        if (v.item == kNoItem) return 0.0f;
        const float part = partOfPixel(v, level.light[i].predicted, luminanceWeights);
        const bool much = !(v.errorScale > 0) || part > kMuchOfPixel;
        return kBounceChance * trust * (much ? 1 : std::sqrt(std::max(0.0f, part) / kMuchOfPixel));
    };
    parallelFor(choices.size(), kRouletteChunk, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const PathVertex& v = level.at.vertices[i];
            VertexChoice& choice = choices[i];
            const float reflectance = highest(v.albedo);
            if (reflectance <= 0 && !v.isGlossy()) continue;
            choice.isLit = true;
            if (bouncesLeft == 0) continue;
            // With a chance q, the second moment of what paths correct grows by albedo^2 / q a
            // bounce in a closed room: q must not be below the albedo.
            if (reflectance > 0)
                choice.diffuseChance =
                    std::max(chanceToCorrect(i), roulette(reflectance, unlimited));
            choice.sendsDiffuse = chanceOf(v, 1) < choice.diffuseChance;
            if (!v.isGlossy()) continue;
            const LobeRay ray = lobeRayOf(v, level.at.lobeOf(v));
            if (ray.share != Rgb(0, 0, 0))
                choice.lobeChance = roulette(highest(ray.share), unlimited);
            choice.sendsLobe = chanceOf(v, 2) < choice.lobeChance;
        }
    });
    return choices;
}

}  // namespace shadowcache
