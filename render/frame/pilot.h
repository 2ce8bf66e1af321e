#pragma once

#include "render/frame/frame_request.h"

namespace shadowcache {

/// Decides all that is decided of a frame before any of its pixels: with samples by the estimator's
/// pilot, without them by a small picture that tells how wrong the prediction is.
///
/// @param stats  gets what that took
FramePlan planFrame(const FrameRequest& frame, RenderStats& stats);

}  // namespace shadowcache
