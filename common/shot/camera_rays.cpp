#include "common/shot/camera_rays.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/math/limits.h"

namespace shadowcache {

namespace {

/// A point of the unit disc, uniform for a uniform sample. [Shirley & Chiu 1997]
std::array<double, 2> onDisc(double u, double v) {
    const double x = 2 * u - 1, y = 2 * v - 1;
    if (x == 0 && y == 0) return {0, 0};
    const bool wide = std::abs(x) > std::abs(y);
    const double radius = wide ? x : y;
    const double angle = wide ? kPi / 4 * (y / x) : kPi / 2 - kPi / 4 * (x / y);
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// A point of the regular polygon in the unit circle whose first corner is at angle 0.
std::array<double, 2> onPolygon(int corners, double u, double v) {
    const double sector = std::min(std::floor(u * corners), corners - 1.0);
    const double across = u * corners - sector, outward = std::sqrt(v);
    const auto corner = [&](double i) {
        const double angle = 2 * kPi * i / corners;
        return std::array<double, 2>{std::cos(angle), std::sin(angle)};
    };
    const auto a = corner(sector), b = corner(sector + 1);
    return {outward * (a[0] + (b[0] - a[0]) * across), outward * (a[1] + (b[1] - a[1]) * across)};
}

std::array<double, 2> onAperture(const Lens& lens, const LensSample& sample) {
    const auto [x, y] =
        lens.blades > 0 ? onPolygon(lens.blades, sample.u, sample.v) : onDisc(sample.u, sample.v);
    const double cosine = std::cos(lens.rotation), sine = std::sin(lens.rotation);
    return {lens.radius * (x * cosine - y * sine), lens.radius * (x * sine + y * cosine)};
}

}  // namespace

CameraRays::CameraRays(const CameraMove& move, double aspect)
    : move_(move), aspect_(aspect), middle_(move.middle(), aspect) {}

CameraRay CameraRays::through(const FilmPosition& at, const LensSample& sample) const noexcept {
    if (!move_.moves) return middle_.through(at, sample);
    return Still(between(move_.open, move_.close, sample.time), aspect_).through(at, sample);
}

CameraRays::Still::Still(const Camera& camera, double aspect) noexcept
    : camera_(camera),
      aspect_(aspect * camera.pixelAspect),
      tangent_(std::tan(0.5 * camera.fovY)),
      right_(camera.forward.cross(camera.up)) {}

CameraRay CameraRays::Still::clipped(const Vec3d& start, const Vec3d& direction) const noexcept {
    const double cosine = direction.dot(camera_.forward);
    const double skipped = camera_.near / cosine;
    if (!(skipped <= kMostCoordinate)) return {start, direction, cosine, 0, -1};
    return {camera_.near > 0 ? start + direction * skipped : start, direction, cosine, skipped,
            camera_.far / cosine - skipped};
}

CameraRay CameraRays::Still::through(const FilmPosition& at) const noexcept {
    const double x = at.x + camera_.shiftX, y = at.y - camera_.shiftY;
    if (camera_.height > 0)
        return clipped(camera_.origin + right_ * ((x - 0.5) * aspect_ * camera_.height) +
                           camera_.up * ((0.5 - y) * camera_.height),
                       camera_.forward);
    return clipped(camera_.origin,
                   (camera_.forward + right_ * ((2.0 * x - 1.0) * aspect_ * tangent_) +
                    camera_.up * ((1.0 - 2.0 * y) * tangent_))
                       .normalized());
}

std::optional<FilmPosition> CameraRays::Still::project(const Vec3d& point) const noexcept {
    const Vec3d to = point - camera_.origin;
    const double depth = to.dot(camera_.forward);
    if (!(depth > camera_.near)) return {};
    // Half the film's height, in the plane through the point.
    const double half = camera_.height > 0 ? camera_.height / 2 : depth * tangent_;
    return FilmPosition{0.5 + to.dot(right_) / (2 * half * aspect_) - camera_.shiftX,
                        0.5 - to.dot(camera_.up) / (2 * half) + camera_.shiftY};
}

CameraRay CameraRays::Still::through(const FilmPosition& at,
                                     const LensSample& sample) const noexcept {
    const CameraRay pinhole = through(at);
    if (!(camera_.lens.radius > 0)) return pinhole;
    const Vec3d center = pinhole.start - pinhole.direction * pinhole.skipped;
    const Vec3d sharp = center + pinhole.direction * (camera_.lens.focus / pinhole.cosine);
    const auto [x, y] = onAperture(camera_.lens, sample);
    const Vec3d start = center + right_ * x + camera_.up * y;
    return clipped(start, (sharp - start).normalized());
}

}  // namespace shadowcache
