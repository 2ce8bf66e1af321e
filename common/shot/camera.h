#pragma once

#include <filesystem>
#include <vector>

#include "common/math/vec.h"

namespace shadowcache {

/// Camera in world space.
struct Camera {
    Vec3d origin{0, 0, 0};
    Vec3d forward{0, 0, -1};  ///< unit
    Vec3d up{0, 1, 0};        ///< unit, at right angles to forward
    double fovY = 1.0;        ///< full vertical angle of view in radians, in (0, pi)
    double height = 0;        ///< above 0: orthographic, with a view of that height; no fovY
};

/// Moving camera of a file.
struct CameraTrack {
    std::filesystem::path path;
    double fovY = 1.0;
    double fps = 30.0;
    std::vector<Camera> frames;  ///< frames[0] is frame 1
};

/// Camera at `eye` that sees `target` in the middle of the picture.
///
/// @throws Error if the two coincide, `up` points along the view or fovY is out of (0, pi)
Camera lookAt(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double fovY);

/// A place on the film.
struct FilmPosition {
    double x;  ///< 0 at the picture's left, 1 at its right
    double y;  ///< 0 at the top, 1 at the bottom
};

/// The rays of a camera through its film: what they share is computed once.
class CameraRays {
public:
    /// @param aspect  width / height of the film
    CameraRays(const Camera& camera, double aspect) noexcept;

    /// Where the ray through a film position starts.
    Vec3d start(const FilmPosition& at) const noexcept;

    /// Its unit direction.
    Vec3d direction(const FilmPosition& at) const noexcept;

private:
    Camera camera_;
    double aspect_, tangent_;
    Vec3d right_;
};

/// Reads {"cam": {"yfov": radians, "fps": number, "frames": [{"origin": [x, y, z],
/// "forward": [x, y, z], "up": [x, y, z]}, ...]}}; other keys are ignored, save a "version" at the
/// top, which must be 1. Directions need not be unit vectors.
///
/// @throws Error naming the file, the key, the value found and the one wanted
CameraTrack readCameraFile(const std::filesystem::path& path);

/// Camera of a frame, counted from 1.
///
/// @throws Error if the track has no such frame
const Camera& cameraAtFrame(const CameraTrack& track, long long frame);

}  // namespace shadowcache
