#pragma once

#include <filesystem>
#include <limits>
#include <vector>

#include "common/math/vec.h"

namespace shadowcache {

/// A thin lens.
struct Lens {
    double radius = 0;  ///< of the aperture, in metres; 0: a pinhole, all is sharp
    double focus = 1;   ///< distance of the plane that is sharp, along the view, in metres, above 0
    int blades = 0;     ///< corners of the aperture, 3 or more; 0: it is round
    double rotation = 0;  ///< of the blades, in radians, counter-clockwise as the camera looks
};

/// Camera in world space.
struct Camera {
    Vec3d origin{0, 0, 0};    ///< where it stands
    Vec3d forward{0, 0, -1};  ///< unit
    Vec3d up{0, 1, 0};        ///< unit, at right angles to forward
    double fovY = 1.0;        ///< full vertical angle of view in radians, in (0, pi)
    double height = 0;        ///< above 0: orthographic, with a view of that height; no fovY
    double shiftX = 0;        ///< of the view to the right, in widths of the picture
    double shiftY = 0;        ///< upward, in its heights
    double pixelAspect = 1;   ///< width of a pixel over its height, above 0
    double aspect = 0;        ///< width over height of the picture that it is made for; 0: of any
    double near = 0;          ///< distance along the view from which on things are seen, >= 0
    double far = std::numeric_limits<double>::infinity();  ///< and up to which, above `near`
    Lens lens{};                                           ///< a pinhole, unless it has a radius
};

/// Camera of a share t in [0, 1] of the way from one to another of the same kind, linear in all
/// that has a length or an angle.
///
/// @throws Error if one is orthographic and the other is not, or they differ by a right angle or
///   more
Camera between(const Camera& a, const Camera& b, double t);

/// A camera while the shutter is open.
struct CameraMove {
    /// One that stands still.
    // NOLINTNEXTLINE(google-explicit-constructor): wherever a move is wanted, a camera will do
    CameraMove(const Camera& still) : open(still), close(still) {}
    /// One that goes from one place to another.
    CameraMove(const Camera& atOpening, const Camera& atClosing)
        : open(atOpening), close(atClosing), moves(true) {}

    Camera open, close;  ///< when the shutter opens and when it closes
    bool moves = false;  ///< false: it stands still, as `open`

    /// In the middle of the exposure.
    Camera middle() const { return moves ? between(open, close, 0.5) : open; }
};

/// Moving camera of a file.
struct CameraTrack {
    std::filesystem::path path;  ///< the file
    double fovY = 1.0;           ///< Camera::fovY of frames that have none of their own
    double fps = 30.0;           ///< frames a second
    std::vector<Camera> frames;  ///< frames[0] is frame 1
};

/// A vector of length 1 that neither overflows nor underflows on its way, for any finite one; zero
/// of zero.
Vec3d unitOf(const Vec3d& v);

/// Unit vector at right angles to the unit vector `forward`, on the side of `up`; zero if there is
/// none.
Vec3d uprightOf(const Vec3d& forward, const Vec3d& up);

/// Camera at `eye` that sees `target` in the middle of the picture.
///
/// @throws Error if the two coincide, `up` points along the view or fovY is out of (0, pi)
Camera lookAt(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double fovY);

/// Camera of a frame, counted from 1.
///
/// @throws Error if the track has no such frame
const Camera& cameraAtFrame(const CameraTrack& track, long long frame);

/// Camera at a time in frames, between those of two frames; before the first frame it is the
/// first's, after the last the last's.
Camera cameraAtTime(const CameraTrack& track, double time);

}  // namespace shadowcache
