#pragma once

#include <span>

#include "common/predict/places.h"
#include "render/estimators/emitter_light.h"

namespace shadowcache {

// Irradiance of places by what shines in their set itself, before it bounces [radiance sr]. Of what
// is no place (isPlace()) it is 0.

/// As the counts of a cache predict it: no rays. Of emitters that it does not count as if nothing
/// were in the way.
void predictOwnLight(const Scene& scene, const EmitterLight& light, const Places& places,
                     std::span<Rgb> out);

/// Adds it by 1,024 rays to the emitters of each place: without bias, whatever the cache knows.
///
/// @param which  of the places, whose values of `out` are added to
void addOwnLightByRays(const Scene& scene, const EmitterLight& light, const Places& places,
                       std::span<const std::size_t> which, std::span<Rgb> out);

}  // namespace shadowcache
