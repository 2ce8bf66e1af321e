#pragma once

#include <span>

#include "render/frame/integrator.h"

namespace shadowcache {

/// relMSE of a picture as the variance that its estimators found in their own samples tells it.
double measuredError(std::span<const Pixel> pixels, const Rgb& luminanceWeights);

/// Samples that bring a frame to relMSE `target` (> 0), from a pilot: a sixteenth of its tiles,
/// drawn with other random numbers than the picture, so that the picture stays unbiased whatever
/// the pilot found. Leaves the estimator surveyed for that number.
///
/// @return 1 .. kMostSamples
int samplesForError(FrameRequest frame, double target, RenderStats& stats);

}  // namespace shadowcache
