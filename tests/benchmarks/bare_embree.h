#pragma once

#include <vector>

#include "tests/benchmarks/embree_spy.h"

namespace shadowcache::bench {

/// Rays a second of nothing but Embree's occlusion calls, per second of processor time.
struct BareRates {
    double single = 0;   ///< rtcOccluded1
    double packet = 0;   ///< rtcOccluded8, told that rays are coherent
    double stream = 0;   ///< rtcOccluded1M
    double orderly = 0;  ///< rtcOccluded1M, told that rays are coherent

    double best() const;
};

/// Traces recorded rays in their order in every way, a few rounds each. Filling Embree's
/// structures is not counted.
BareRates measureBareEmbree(RTCScene scene, const std::vector<Burst>& bursts);

/// Processor time of this process (of all its threads), in seconds.
double processorSeconds();

}  // namespace shadowcache::bench
