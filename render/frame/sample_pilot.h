#pragma once

#include "render/frame/frame_request.h"

namespace shadowcache {

/// Lets the estimator's pilot look at a frame with samples through a few of its pixels, and decides
/// with what it predicts there where pixels get more camera rays.
///
/// @param stats  gets what that took
FramePlan planSamples(const FrameRequest& frame, RenderStats& stats);

}  // namespace shadowcache
