#pragma once

#include "render/frame/integrator.h"

namespace shadowcache {

/// Prints to standard output how the pixel (x, y) of a frame comes about: place, normal, cache
/// items, estimate, and each sample with what its ray met.
///
/// @throws Error if the estimate is not finite
void reportPixel(const Estimator& estimator, const EstimatorContext& context, const Camera& camera,
                 int frame, const RenderOptions& options, int x, int y);

}  // namespace shadowcache
