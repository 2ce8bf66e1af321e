#pragma once

#include <filesystem>

#include "common/shot/camera.h"

namespace shadowcache {

/// Corners of an aperture at most.
inline constexpr int kMostBlades = 64;

/// Reads a camera move, {"cam": {"yfov": radians, "fps": number, "frames": [{"origin": [x, y, z],
/// "forward": [x, y, z], "up": [x, y, z]}, ...]}}. Directions need not be unit vectors. "cam", for
/// all frames, and each frame for itself may also have
///
/// - "yfov", or "height" of the view in metres: orthographic;
/// - "shift": [x, y], in widths and heights of the picture, to the right and upward;
/// - "pixel_aspect": width of a pixel over its height;
/// - "near", "far": distances along the view of the first and the last thing seen, in metres;
/// - "lens": {"radius": metres, "focus": metres, "blades": number, "rotation": radians}, of which
///   "blades" (3 or more; 0: round) and "rotation" may be missing.
///
/// Other keys are ignored, save a "version" at the top, which must be 1.
///
/// @throws Error naming the file, the key, the value found and the one wanted
CameraTrack readCameraFile(const std::filesystem::path& path);

}  // namespace shadowcache
