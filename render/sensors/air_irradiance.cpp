#include "render/sensors/air_irradiance.h"

#include <fmt/core.h>

#include <cmath>
#include <cstdint>

#include "common/base/error.h"
#include "common/base/interrupt.h"
#include "common/base/parallel.h"
#include "common/predict/cell_light.h"
#include "render/sensors/air_view.h"

namespace shadowcache {

namespace {

/// Light of the cells that the view sees.
Rgb skyLight(const Environment& environment, const AirView& view, const Vec3f& normal) {
    Vec3d sum(0.0);
    CellLight light;
    for (std::uint32_t first = 0; first < view.sky.size(); first += kBlockCells) {
        const float* seen = view.sky.data() + first;
        bool any = false;
        for (int i = 0; i < kBlockCells; ++i) any = any || seen[i] > 0;
        if (!any) continue;
        lightCells(environment.cells(Environment::kLevel, first / kBlockCells), normal,
                   environment.luminanceWeights(), light);
        for (int i = 0; i < kBlockCells; ++i)
            for (int k = 0; k < 3; ++k)
                if (seen[i] > 0) sum[k] += static_cast<double>(light.irradiance[k][i]);
    }
    return Rgb(sum);
}

Rgb surfaceLight(const BouncingLight& bouncing, const AirView& view) {
    // What leaves a surface that light meets last has met one surface less before.
    const int before = bouncing.bounces < 0 ? -1 : bouncing.bounces - 1;
    Vec3d sum(0.0);
    for (const AirView::Met& met : view.met) {
        const ItemLook& look = bouncing.looks[met.item];
        const Rgb radiance =
            look.albedo * bouncing.solve.irradiance(met.item, before) * static_cast<float>(1 / kPi);
        sum += Vec3d(radiance) * static_cast<double>(met.share);
    }
    return Rgb(sum);
}

}  // namespace

bool isOnSurface(const Scene& scene, double spacing, const Vec3d& position, const Vec3f& normal) {
    constexpr double kAbove = 0.1, kBelow = 0.25;  // of a voxel
    constexpr float kLeastFacing = 0.5f;           // cosine, as of the items of a lookup
    const Vec3d above = position + Vec3d(normal) * (kBelow * spacing);
    RayPacket ray{};
    ray.set(0, Vec3f(above - scene.mesh().origin), -normal);
    Hit hit;
    scene.meet(ray, 1, &hit);
    return hit.found && static_cast<double>(hit.distance) <= (kBelow + kAbove) * spacing &&
           std::abs(hit.normal.dot(normal)) >= kLeastFacing;
}

namespace {

bool isKnown(const Rgb& value) {
    return !std::isnan(value.x);
}
bool isKnown(float value) {
    return !std::isnan(value);
}

template <class Value>
std::vector<std::size_t> inAirOf(const Scene* scene, double spacing, const Places& places,
                                 std::span<const Value> predicted) {
    std::vector<std::uint8_t> inAir(places.size(), 0);
    parallelFor(places.size(), 4096, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i)
            inAir[i] = isPlace(places, i) &&
                       (!isKnown(predicted[i]) ||
                        (scene && !isOnSurface(*scene, spacing, places.positions[i],
                                               Vec3f(unitAlong(places.normals[i])))));
    });
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < places.size(); ++i)
        if (inAir[i] != 0) all.push_back(i);
    return all;
}

}  // namespace

std::vector<std::size_t> placesInAir(const Scene* scene, double spacing, const Places& places,
                                     std::span<const Rgb> predicted) {
    return inAirOf(scene, spacing, places, predicted);
}

std::vector<std::size_t> placesInAir(const Scene* scene, double spacing, const Places& places,
                                     std::span<const float> predicted) {
    return inAirOf(scene, spacing, places, predicted);
}

void visibilityInAir(const Scene& scene, const Places& places, std::span<const Vec3d> directions,
                     std::span<const std::size_t> which, std::span<float> out) {
    parallelFor(which.size(), 1024, [&](const Chunk& chunk) {
        throwIfInterrupted();
        for (std::size_t k = chunk.begin; k < chunk.end; ++k) {
            const std::size_t i = which[k];
            if (!isDirection(directions[i])) continue;
            RayPacket ray{};
            const Vec3f normal(unitAlong(places.normals[i]));
            ray.set(0, rayStartInAir(scene, places.positions[i], normal),
                    Vec3f(unitAlong(directions[i])));
            out[i] = scene.visibility(ray, 1) != 0 ? 1.0f : 0.0f;
        }
    });
}

void refuseInAir(const Vec3d& position) {
    throw Error(
        fmt::format("points: ({:g}, {:g}, {:g}) is at no surface that the cache knows; with "
                    "scene=, rays answer for places in the air",
                    position.x, position.y, position.z));
}

void irradianceInAir(const Scene& scene, const Environment& environment,
                     const BouncingLight* bouncing, const Places& places,
                     std::span<const std::size_t> which, std::span<Rgb> out) {
    if (which.empty()) return;
    const PatchCosines cosines;
    const ItemTable* items = bouncing ? &bouncing->solve.items() : nullptr;
    parallelFor(which.size(), 64, [&](const Chunk& chunk) {
        AirViewer viewer(scene, cosines, items);
        for (std::size_t k = chunk.begin; k < chunk.end; ++k) {
            throwIfInterrupted();
            const std::size_t i = which[k];
            const Vec3f normal(unitAlong(places.normals[i]));
            const AirView& view = viewer.look(places.positions[i], normal);
            out[i] = skyLight(environment, view, normal);
            if (bouncing) out[i] += surfaceLight(*bouncing, view);
        }
    });
}

}  // namespace shadowcache
