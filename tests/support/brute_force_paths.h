#pragma once

#include "common/light/environment.h"
#include "common/mesh/looks.h"
#include "common/trace/scene.h"

namespace shadowcache::test {

// A path tracer of a page: one ray at a time, by the BRDF alone. It shares the surfaces and the
// scene with the product, but no estimator, no cache and no reuse.

/// Radiance that a camera ray sees, by one path with up to `bounces` surfaces before the one that
/// is seen; below 0: until Russian roulette ends it.
///
/// @param seed  of the path
Rgb pathRadiance(const Scene& scene, const Environment& environment, const PlainLook& plain,
                 const Vec3f& origin, const Vec3f& direction, int bounces, std::uint64_t seed);

/// The mean of as many paths as `count`, in parallel; their seeds are 1 .. count, hashed with
/// `seed`.
Rgb meanPathRadiance(const Scene& scene, const Environment& environment, const PlainLook& plain,
                     const Vec3f& origin, const Vec3f& direction, int bounces, std::uint64_t seed,
                     int count);

}  // namespace shadowcache::test
