#pragma once

#include <string>

#include "common/image/exr.h"
#include "common/shot/camera.h"

namespace shadowcache {

/// What the EXR of a frame says of its camera.
///
/// @param width, height  of the whole frame [pixels]
ExrView viewOf(const Camera& camera, int width, int height);

/// How a picture shows more or less to its sides than its camera is made for; empty: it does not.
///
/// @param width, height  of the whole frame [pixels]
std::string aspectNote(const Camera& camera, int width, int height);

/// Distance along the view of what is farthest in a box in world space.
double farthestOf(const Camera& camera, const Box3d& box);

}  // namespace shadowcache
