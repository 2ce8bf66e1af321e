#pragma once

#include "tests/benchmarks/bench.h"

namespace shadowcache::bench {

/// Two pictures of different seeds, and what one of them takes.
struct Pair {
    Image a, b;
    double seconds = 0;  ///< of the processor, over the threads

    /// Of one picture: that of the difference, which holds the noise of both, over the root of 2.
    /// That Cycles filters the map otherwise does not count.
    RelativeError noise(const Image& reference) const;
};

/// Two pictures of 320x180 by Blender's Cycles, of all surfaces of albedo 0.5.
///
/// @param samples  of a pixel
/// @param bounces  surfaces that light may meet before the one that is seen
/// @throws Error with Blender's own words if it fails
Pair cyclesPair(const Settings& settings, const Frame& frame, int samples, int bounces);

}  // namespace shadowcache::bench
