#pragma once

#include <cstdint>
#include <span>

#include "common/predict/many_places.h"
#include "render/samples/light_sampler.h"

namespace shadowcache {

/// Which sequences places have.
struct PlaceSequences {
    std::uint64_t seed = 1;
    std::uint64_t first = 0;  ///< number of the first place: parts of many places have theirs
};

/// Draws directions to the light at many places at once, on all threads: at each an Owen-scrambled
/// Sobol' sequence of its own.
///
/// @param places     those that are not finite, or have a normal of length 0, get samples with
///                   pdf 0 and a NaN integral
/// @param samples    the same number for each place, one place after the other; pdf 0 where no
///                   light reaches the place
/// @param integrals  LightSampler::Reader::integral() of each place
/// @throws Error naming the cache's file if that cannot be read any more
void samplePlaces(const LightSampler& sampler, const Places& places, SampleAim aim,
                  const PlaceSequences& sequences, std::span<LightSample> samples,
                  std::span<Rgb> integrals);

/// What is known along one direction from each place: LightSampler::Reader::along().
///
/// @param directions  as many; of any length
/// @param out         as many; pdf NaN where place or direction is not finite or 0
/// @throws Error naming the cache's file if that cannot be read any more
void readAlong(const LightSampler& sampler, const Places& places, SampleAim aim,
               std::span<const Vec3d> directions, std::span<LightSample> out);

}  // namespace shadowcache
