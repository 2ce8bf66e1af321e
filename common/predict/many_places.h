#pragma once

#include <span>

#include "common/cache/shadow_cache.h"
#include "common/predict/bounce_solve.h"
#include "common/predict/cache_preview.h"
#include "common/predict/places.h"

namespace shadowcache {

// What a cache predicts at many places at once: near ones are looked up one after the other, which
// is faster, on all threads. The results are those of one place at a time, in the order given.
// Those that are no places (isPlace()) find nothing.

/// Irradiance [radiance sr].
///
/// @param preview  of an environment and of the cache's tiers
/// @param out      as many; NaN where the cache has no item
/// @throws Error naming the cache's file if that cannot be read any more
void irradianceAt(const ShadowCache& cache, const CachePreview& preview, const Places& places,
                  std::span<Rgb> out);

/// The same with the light of up to `bounces` bounces (BounceSolve), over the exposed share of the
/// items' surface.
///
/// @param solve  of the same environment and cache
/// @param more   direct light of each place beside the environment's; may be empty
void irradianceAt(const ShadowCache& cache, const CachePreview& preview, const BounceSolve& solve,
                  int bounces, const Places& places, std::span<Rgb> out,
                  std::span<const Rgb> more = {});

/// Visible share of the sky around a direction.
///
/// @param directions  as many; of any length
/// @param out         as many, in [0, 1]; NaN where the cache has no item, 1 where nothing was
///                    counted
/// @throws Error naming the cache's file if that cannot be read any more
void visibilityAt(const ShadowCache& cache, const Places& places, std::span<const Vec3d> directions,
                  std::span<float> out);

}  // namespace shadowcache
