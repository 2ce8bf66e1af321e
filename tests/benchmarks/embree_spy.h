#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <vector>

namespace shadowcache::bench {

/// The program defines the Embree calls that the project uses itself, so that the linker binds to
/// them; they forward to the library and, while spying, count, time or record what passes. Nothing
/// in the project knows of it.

enum class Spying {
    off,
    count,   ///< rays
    time,    ///< rays, and seconds in Embree: slower by two looks at the clock a call
    record,  ///< rays, and a sample of them
};

/// Starts anew from zero. Not while other threads trace.
void spy(Spying mode);

/// Rays of one thread, in the order of their calls: origin, direction, reach.
using Burst = std::vector<std::array<float, 7>>;

struct Spied {
    std::uint64_t rays = 0;
    std::uint64_t calls = 0;
    double seconds = 0;  ///< in Embree, summed over threads, the clock's own cost taken off
    std::vector<Burst> bursts;
};

/// What was seen since spy(), which ends.
Spied endSpying();

/// Embree's scene that the last recorded call went to.
RTCScene lastScene();

}  // namespace shadowcache::bench
