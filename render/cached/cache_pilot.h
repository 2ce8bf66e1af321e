#pragma once

#include <cstdint>
#include <span>

#include "render/cached/cache_plan.h"

namespace shadowcache {

/// A plan, and what it took.
struct PilotResult {
    CachePlan plan;
    std::uint64_t rays = 0;
};

/// Plans a frame by some of its places: compares what the counts predict there with a few rays,
/// half of them where the counts are unsure and half where the light is.
///
/// @param adaptive  samples are shared out by predicted noise
/// @param samples, otherError  as FramePilot::run()
PilotResult runCachePilot(const EstimatorContext& context, bool adaptive,
                          std::span<const ShadingPoint> points, int samples, double otherError);

}  // namespace shadowcache
