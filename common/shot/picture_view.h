#pragma once

#include "common/image/exr.h"
#include "common/shot/camera.h"

namespace shadowcache {

/// What the EXR of a frame says of its camera.
///
/// @param width, height  of the whole frame [pixels]
ExrView viewOf(const Camera& camera, int width, int height);

}  // namespace shadowcache
