#pragma once

#include <memory>
#include <span>

#include "render/cached/cache_plan.h"
#include "render/estimators/estimator.h"

namespace shadowcache {

/// Plans a frame by some of its places: compares what the counts predict there with a few rays,
/// half of them where the counts are unsure and half where the light is.
///
/// @param adaptive  samples are shared out by predicted noise
/// @param samples, cameraRayError  as FramePilot::plan()
std::unique_ptr<const CachePlan> planByCache(const EstimatorContext& context, bool adaptive,
                                             std::span<const ShadingPoint> points, int samples,
                                             double cameraRayError);

}  // namespace shadowcache
