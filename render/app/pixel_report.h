#pragma once

#include "render/frame/integrator.h"

namespace shadowcache {

/// Prints to standard output how the pixel (x, y) of a frame comes about: place, normal, cache
/// items, estimate, and each sample with what its ray met.
///
/// @throws Error if the estimate is not finite
void reportPixel(const FrameRequest& frame, int x, int y);

}  // namespace shadowcache
