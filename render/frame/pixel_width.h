#pragma once

#include <cmath>

#include "common/shot/camera.h"
#include "render/frame/options.h"

namespace shadowcache {

/// Width of a pixel at a distance; the same at all, if the camera is orthographic. [length]
inline float pixelWidth(const Camera& camera, const RenderOptions& options, float depth) {
    if (camera.height > 0) return static_cast<float>(camera.height / options.height);
    return depth * static_cast<float>(2 * std::tan(camera.fovY / 2) / options.height);
}

}  // namespace shadowcache
