#pragma once

#include <span>

#include "render/frame/integrator.h"

namespace shadowcache {

/// relMSE of a picture, estimated from the spread of its camera rays.
double measuredError(std::span<const Pixel> pixels, const Rgb& luminanceWeights);

/// A frame with its plan, for an error.
struct TargetPlan {
    FrameRequest frame;
    double correction = 1;  ///< error found by the pilot over that of measuredError()
};

/// Sets the camera rays of each tile of a frame so that its relMSE comes to `target` (> 0): pixels
/// whole, with edges and sky. A pilot finds out where they are needed. Its random numbers are not
/// the picture's, so that the picture stays unbiased whatever the pilot found.
TargetPlan planForError(FrameRequest frame, double target, RenderStats& stats);

}  // namespace shadowcache
