#pragma once

#include <span>

#include "render/frame/integrator.h"

namespace shadowcache {

/// relMSE of a picture as the spread of its camera rays tells it.
double measuredError(std::span<const Pixel> pixels, const Rgb& luminanceWeights);

/// Sets the camera rays of each tile of a frame so that its relMSE comes to `target` (> 0): pixels
/// whole, with edges and sky. A pilot finds out where they are needed. Its random numbers are not
/// the picture's, so that the picture stays unbiased whatever the pilot found. Leaves the estimator
/// surveyed for the frame.
///
/// @return how much more error there is than measuredError() tells, as the pilot found
double planForError(FrameRequest& frame, double target, RenderStats& stats);

}  // namespace shadowcache
