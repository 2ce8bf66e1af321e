#include "common/shot/camera.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "common/base/error.h"
#include "common/math/limits.h"

namespace shadowcache {

namespace {

/// Sine of the least angle between the view and `up`; below it, rounding would choose the roll.
constexpr double kLeastUpSine = 1e-6;

std::string placeText(const Vec3d& p) {
    return fmt::format("{:g},{:g},{:g}", p.x, p.y, p.z);
}

double mix(double a, double b, double t) {
    return a == b ? a : a + (b - a) * t;
}

/// Where one sees as far as it goes, so does what is between them.
double mixReach(double a, double b, double t) {
    return std::isfinite(a) && std::isfinite(b) ? mix(a, b, t) : std::max(a, b);
}

}  // namespace

Vec3d unitOf(const Vec3d& v) {
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    return largest > 0.0 ? (v / largest).normalized() : Vec3d(0.0);
}

Vec3d uprightOf(const Vec3d& forward, const Vec3d& up) {
    const Vec3d right = forward.cross(unitOf(up));
    return right.length() > kLeastUpSine ? right.normalized().cross(forward).normalized()
                                         : Vec3d(0.0);
}

Camera lookAt(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double fovY) {
    if (!(fovY > 0.0 && fovY < kPi)) {
        throw Error(fmt::format("angle of view {:f}, expected one in (0, pi)", fovY));
    }
    for (const Vec3d& place : {eye, target})
        if (!isInReach(place))
            throw Error(fmt::format("camera or its target at {}, expected coordinates up to {:g}",
                                    placeText(place), kMostCoordinate));
    Camera camera;
    camera.fovY = fovY;
    camera.origin = eye;
    camera.forward = unitOf(target - eye);
    if (!(camera.forward.length2() > 0.5)) {
        throw Error("camera and target coincide, expected two places");
    }
    camera.up = uprightOf(camera.forward, up);
    if (camera.up == Vec3d(0.0)) throw Error("camera looks along its up vector");
    return camera;
}

Camera between(const Camera& a, const Camera& b, double t) {
    if ((a.height > 0) != (b.height > 0))
        throw Error("a perspective camera and an orthographic one have none between them");
    if (!(a.forward.dot(b.forward) > 0 && a.up.dot(b.up) > 0))
        throw Error("the camera turns by a right angle or more from one frame to the next");
    Camera c;
    c.origin = a.origin + (b.origin - a.origin) * t;
    c.forward = unitOf(a.forward + (b.forward - a.forward) * t);
    c.up = uprightOf(c.forward, a.up + (b.up - a.up) * t);
    c.fovY = mix(a.fovY, b.fovY, t);
    c.height = mix(a.height, b.height, t);
    c.shiftX = mix(a.shiftX, b.shiftX, t);
    c.shiftY = mix(a.shiftY, b.shiftY, t);
    c.pixelAspect = a.pixelAspect;
    c.aspect = a.aspect;
    c.near = mix(a.near, b.near, t);
    c.far = mixReach(a.far, b.far, t);
    c.lens = {mix(a.lens.radius, b.lens.radius, t), mix(a.lens.focus, b.lens.focus, t),
              a.lens.blades, mix(a.lens.rotation, b.lens.rotation, t)};
    return c;
}

const Camera& cameraAtFrame(const CameraTrack& track, long long frame) {
    const auto count = static_cast<long long>(track.frames.size());
    if (frame < 1 || frame > count) {
        throwFileError(track.path,
                       fmt::format("frame {0} of {1}, expected 1 to {1}", frame, count));
    }
    return track.frames[static_cast<std::size_t>(frame - 1)];
}

Camera cameraAtTime(const CameraTrack& track, double time) {
    const auto last = static_cast<double>(track.frames.size() - 1);
    const double at = std::clamp(time - 1, 0.0, last);
    const double first = std::floor(at);
    const auto i = static_cast<std::size_t>(first);
    if (at == first) return track.frames[i];
    return between(track.frames[i], track.frames[i + 1], at - first);
}

}  // namespace shadowcache
