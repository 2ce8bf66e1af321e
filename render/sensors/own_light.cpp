#include "render/sensors/own_light.h"

#include <array>
#include <bit>
#include <cstdint>

#include "common/base/hash.h"
#include "common/base/interrupt.h"
#include "common/base/parallel.h"
#include "render/sensors/air_view.h"

namespace shadowcache {

namespace {

/// Rays to emitters of a place: of an area that is seen whole, less than 1 per cent of noise.
constexpr int kRays = 1024;

/// Place i.
SetPlace placeOf(const Scene& scene, const Places& places, std::size_t i) {
    const Vec3f normal(unitAlong(places.normals[i]));
    const Vec3d& position = places.positions[i];
    return {rayStartInAir(scene, position, normal), position, normal, normal};
}

/// The same of a place whatever others there are.
std::uint64_t seedOf(const Vec3d& position) {
    const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value + 0.0); };
    return hashWords(bits(position.x), bits(position.y), bits(position.z));
}

}  // namespace

void predictOwnLight(const Scene& scene, const EmitterLight& light, const Places& places,
                     std::span<Rgb> out) {
    parallelFor(places.size(), 1024, [&](const Chunk& chunk) {
        throwIfInterrupted();
        EmitterLight::Tools tools(light);
        for (std::size_t i = chunk.begin; i < chunk.end; ++i)
            out[i] =
                isPlace(places, i) ? light.predict(placeOf(scene, places, i), tools) : Rgb(0, 0, 0);
    });
}

void addOwnLightByRays(const Scene& scene, const EmitterLight& light, const Places& places,
                       std::span<const std::size_t> which, std::span<Rgb> out) {
    parallelFor(which.size(), 64, [&](const Chunk& chunk) {
        EmitterLight::Tools tools(light);
        for (std::size_t k = chunk.begin; k < chunk.end; ++k) {
            throwIfInterrupted();
            const std::size_t i = which[k];
            const std::array points{ShadingPoint{placeOf(scene, places, i),
                                                 BatchSlot{.seed = seedOf(places.positions[i])}}};
            std::array<Estimate, 1> estimate{};
            light.addIrradiance({.points = points, .samples = kRays}, Rgb(1.0f / 3), tools,
                                estimate);
            out[i] += estimate[0].irradiance;
        }
    });
}

}  // namespace shadowcache
