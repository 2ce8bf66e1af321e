#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/predict/bounce_solve.h"
#include "common/predict/places.h"
#include "common/trace/scene.h"

namespace shadowcache {

/// Whether a place lies on a surface of the set that looks along its normal: up to a tenth of a
/// voxel above it, or a quarter below, as the mean points of items of curved surfaces. A cache has
/// items for others near one, too, which know nothing of their light.
///
/// @param spacing   of the cache
/// @param position  world space
/// @param normal    unit
bool isOnSurface(const Scene& scene, double spacing, const Vec3d& position, const Vec3f& normal);

/// Places that a cache predicts nothing for: it has no item, or they are not isOnSurface().
///
/// @param scene      null: items are all that is known
/// @param predicted  of irradianceAt(), which leaves those without an item NaN
std::vector<std::size_t> placesInAir(const Scene* scene, double spacing, const Places& places,
                                     std::span<const Rgb> predicted);

/// The same of visibilityAt().
std::vector<std::size_t> placesInAir(const Scene* scene, double spacing, const Places& places,
                                     std::span<const float> predicted);

/// Visibility of the sky from places in the air, by a ray along each direction: 1 or 0.
///
/// @param directions  as many as places, of any length; what is no direction keeps its value
/// @param which       of the places, whose values of `out` are written
void visibilityInAir(const Scene& scene, const Places& places, std::span<const Vec3d> directions,
                     std::span<const std::size_t> which, std::span<float> out);

/// Refuses a place in the air where no set is at hand to trace its rays in.
/// @throws Error
[[noreturn]] void refuseInAir(const Vec3d& position);

/// Light that bounces in a set, for places that see its surfaces.
struct BouncingLight {
    const BounceSolve& solve;
    std::span<const ItemLook> looks;  ///< by item
    int bounces;                      ///< below 0: all
};

/// Irradiance of places in the air: of the sky where a ray through the middle of each cell of
/// Environment::kLevel reaches it, and what the surfaces that the others meet reflect [radiance
/// sr].
///
/// @param bouncing  null: of the sky alone
/// @param which     of the places, whose values of `out` are written
void irradianceInAir(const Scene& scene, const Environment& environment,
                     const BouncingLight* bouncing, const Places& places,
                     std::span<const std::size_t> which, std::span<Rgb> out);

}  // namespace shadowcache
