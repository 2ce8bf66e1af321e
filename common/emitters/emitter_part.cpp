#include "common/emitters/emitter_part.h"

#include <algorithm>
#include <cmath>

#include "common/emitters/lit_cap.h"
#include "common/emitters/lit_triangle.h"

namespace shadowcache {

namespace {

/// Distance in longest sides up to which points of a triangle are drawn in solid angle: farther
/// away, area does as well.
constexpr float kNear = 3;

/// Least width of a spot's falloff, in the cosine. [KHR_lights_punctual]
constexpr double kLeastFalloff = 0.001;

/// Weight of what a spot sends at most to a place that its cone grazes: no direction is missed.
constexpr double kLeastConeShare = 0.05;

/// So much beyond its edges a triangle of a lamp is met, so that rounding leaves no gap between
/// two.
constexpr double kOverlap = 1e-9;

/// A lamp as a place sees it.
struct Cap {
    Vec3d axis{0, 0, 0};     ///< unit; 0: there is none
    double sineSquared = 0;  ///< of the angle around the axis
    double distance = 0;     ///< to the lamp's middle
    double across = 0;       ///< irradiance across the axis by a radiance of 1
};

double shareOf(const LampCone& cone, double cosine) {
    const double width = std::max(cone.cosInner - cone.cosOuter, kLeastFalloff);
    const double x = std::clamp((cosine - cone.cosOuter) / width, 0.0, 1.0);
    return (cone.smooth ? x * x * (3 - 2 * x) : x * x) * (cone.isFlat ? cosine : 1);
}

/// What a spot's cone leaves of its radiance in a direction, seen from a place; 1 of other lamps.
double shareTowards(const EmitterPart& lamp, const Vec3d& direction) {
    return lamp.cone ? shareOf(*lamp.cone, -direction.dot(Vec3d(lamp.normal))) : 1;
}

/// The same of a whole cap.
struct ConeShare {
    double mean = 1;  ///< about
    double most = 1;
};
ConeShare shareOfCap(const EmitterPart& lamp, const Cap& cap) {
    if (!lamp.cone) return {};
    if (cap.sineSquared == 0) {
        const double share = shareTowards(lamp, cap.axis);
        return {share, share};
    }
    const double angle = std::acos(std::clamp(-cap.axis.dot(Vec3d(lamp.normal)), -1.0, 1.0));
    const double half = std::asin(std::sqrt(std::min(cap.sineSquared, 1.0)));
    const auto at = [&](double x) {
        return shareOf(*lamp.cone, std::cos(std::max(0.0, angle + x * half)));
    };
    // Gauss's rule for how wide a disc is at x.
    const double root = std::sqrt(0.5);
    return {0.5 * at(0) + 0.25 * (at(-root) + at(root)), at(-1)};
}

Cap capOf(const EmitterPart& lamp, const Receiver& at) {
    const auto area = static_cast<double>(lamp.area);
    const Vec3d shines(lamp.normal);
    if (lamp.form == EmitterPart::Form::sun)
        return {-shines, static_cast<double>(lamp.sineSquared),
                std::numeric_limits<double>::infinity(), area};
    const Vec3d way = Vec3d(lamp.centre) - Vec3d(at.position);
    const double squared = way.length2();
    if (!(squared > 0)) return {};
    const double distance = std::sqrt(squared);
    const double r2 = static_cast<double>(lamp.radius) * static_cast<double>(lamp.radius);
    return {way / distance, r2 / (squared + r2), distance, area / (squared + r2)};
}

Unoccluded irradianceByCap(const EmitterPart& lamp, const Receiver& at) noexcept {
    const Cap cap = capOf(lamp, at);
    const double cosine = cap.axis.dot(Vec3d(at.normal));
    const double integral = cap.across * capCosine(cosine, cap.sineSquared);
    const ConeShare share = shareOfCap(lamp, cap);
    return {lamp.radiance * static_cast<float>(integral * share.mean),
            lamp.weight *
                static_cast<float>(integral * std::max(share.mean, kLeastConeShare * share.most))};
}

/// Irradiance by a triangle that is far, with a radiance of 1, by the middles of its sides: exact
/// for what is quadratic over it. [Strang & Fix 1973]
///
/// @param front  distance of the place from the triangle's plane
float irradianceByFar(const EmitterPart& t, const Receiver& at, float front) noexcept {
    float sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3f way = (t.corner[i] + t.corner[(i + 1) % 3]) * 0.5f - at.position;
        const float squared = way.length2();
        sum += (at.normal.dot(way) / squared) * (front / squared);
    }
    return sum * t.area * (1.0f / 3);
}

Unoccluded irradianceByTriangle(const EmitterPart& t, const Receiver& at) noexcept {
    const Vec3f way = t.centre - at.position;
    const float front = -t.normal.dot(way);
    if (front == 0 || (front < 0 && !t.twoSided)) return {};
    const float height = at.normal.dot(way), squared = way.length2();
    if (isBelow(height, t.radius)) return {};
    float integral = 0;
    if (squared > kFarTriangleRadii * kFarTriangleRadii * t.radius * t.radius &&
        std::abs(height) > t.radius) {
        if (height < 0) return {};
        integral = irradianceByFar(t, at, std::abs(front));
    } else {
        const Vec3d place(at.position), n(at.normal);
        const LitPolygon polygon = aboveHorizon(
            {Vec3d(t.corner[0]) - place, Vec3d(t.corner[1]) - place, Vec3d(t.corner[2]) - place},
            n);
        if (polygon.corners == 0) return {};
        // However thin the part above the horizon is, a sample may meet it.
        integral = static_cast<float>(std::max(cosineIntegral(polygon, n), 1e-12));
    }
    return {t.radiance * integral, t.weight * integral};
}

EmitterPoint sampleCapOf(const EmitterPart& lamp, const Receiver& at, double u, double v) noexcept {
    EmitterPoint point;
    const Cap cap = capOf(lamp, at);
    if (!(cap.across > 0)) return point;
    point.isSingle = cap.sineSquared == 0;
    const Vec3d direction = point.isSingle ? cap.axis : sampleCap(cap.axis, cap.sineSquared, u, v);
    point.direction = Vec3f(direction);
    point.density = point.isSingle ? 1 : static_cast<float>(1 / capSolidAngle(cap.sineSquared));
    point.share =
        static_cast<float>(shareTowards(lamp, direction) * (point.isSingle ? cap.across : 1));
    if (lamp.form == EmitterPart::Form::point)
        point.position =
            Vec3f(Vec3d(at.position) + direction * (cap.distance / direction.dot(cap.axis)));
    return point;
}

bool isNear(const EmitterPart& t, const Receiver& at) noexcept {
    return (t.centre - at.position).length2() < kNear * kNear * t.size * t.size;
}

std::array<Vec3d, 3> seenFrom(const EmitterPart& t, const Vec3d& place) {
    return {Vec3d(t.corner[0]) - place, Vec3d(t.corner[1]) - place, Vec3d(t.corner[2]) - place};
}

/// Density of points drawn in area, as seen from a place.
float densityByArea(const EmitterPart& t, const Vec3f& way) noexcept {
    const float squared = way.length2(), front = std::abs(t.normal.dot(way));
    return front > 0 ? squared * std::sqrt(squared) / (front * t.area) : 0.0f;
}

/// Whether a place is on a side of a triangle that emits.
bool isLit(const EmitterPart& t, const Receiver& at) noexcept {
    const float front = -t.normal.dot(t.centre - at.position);
    return front > 0 || (front < 0 && t.twoSided);
}

/// Where a direction meets the plane of a triangle, and its barycentric coordinates there.
struct OnPlane {
    Vec3d way;
    double u = 0, v = 0;
};
OnPlane onPlane(const std::array<Vec3d, 3>& corner, const Vec3d& direction) noexcept {
    const Vec3d side1 = corner[1] - corner[0], side2 = corner[2] - corner[0];
    const Vec3d normal = side1.cross(side2);
    const Vec3d way = direction * (normal.dot(corner[0]) / normal.dot(direction));
    const Vec3d within = way - corner[0];
    return {way, normal.dot(within.cross(side2)) / normal.length2(),
            normal.dot(side1.cross(within)) / normal.length2()};
}

EmitterPoint sampleTriangle(const EmitterPart& t, const Receiver& at, double u, double v) noexcept {
    EmitterPoint point;
    if (!isLit(t, at)) return point;
    const Vec3d place(at.position);
    const std::array<Vec3d, 3> corner = seenFrom(t, place);
    OnPlane on;
    std::optional<LitPolygonSampler> near;
    if (isNear(t, at)) near.emplace(aboveHorizon(corner, Vec3d(at.normal)));
    if (near && near->solidAngle() > 0) {
        const Vec3d direction = near->sample(u, v);
        const Vec3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
        if (!(normal.dot(direction) != 0)) return {};
        on = onPlane(corner, direction);
        point.density = static_cast<float>(1 / near->solidAngle());
    } else {
        // Uniform over the triangle.
        const double root = std::sqrt(u);
        on.u = root * (1 - v);
        on.v = root * v;
        on.way = corner[0] + (corner[1] - corner[0]) * on.u + (corner[2] - corner[0]) * on.v;
        point.density = densityByArea(t, Vec3f(on.way));
    }
    const double along1 = std::clamp(on.u, 0.0, 1.0);
    point.u = static_cast<float>(along1);
    point.v = static_cast<float>(std::clamp(on.v, 0.0, 1 - along1));
    point.position = Vec3f(place + on.way);
    point.direction = Vec3f(on.way.normalized());
    return point;
}

std::optional<LampHit> meetTriangle(const EmitterPart& t, const Receiver& at,
                                    const Vec3f& direction) noexcept {
    if (!isLit(t, at)) return {};
    const OnPlane on = onPlane(seenFrom(t, Vec3d(at.position)), Vec3d(direction));
    const double distance = on.way.dot(Vec3d(direction));
    const double third = 1 - on.u - on.v;
    if (!(distance > 0) || !(std::min({on.u, on.v, third}) >= -kOverlap)) return {};
    return LampHit{static_cast<float>(distance), t.radiance,
                   densityAt(t, at, at.position + Vec3f(on.way))};
}

}  // namespace

Unoccluded irradianceBy(const EmitterPart& part, const Receiver& at) noexcept {
    return part.form == EmitterPart::Form::triangle ? irradianceByTriangle(part, at)
                                                    : irradianceByCap(part, at);
}

float roughWeightBy(const EmitterPart& part, const Receiver& at) noexcept {
    if (part.form == EmitterPart::Form::triangle) {
        const Vec3f way = part.centre - at.position;
        const float squared = way.length2();
        if (squared > kRoughRadii * kRoughRadii * part.radius * part.radius) {
            const float front = -part.normal.dot(way);
            if (front == 0 || (front < 0 && !part.twoSided)) return 0;
            const float height = meanHeight(at.normal.dot(way), part.radius);
            return part.weight * part.area * (std::abs(front) / squared) * (height / squared);
        }
    }
    return irradianceBy(part, at).weight;
}

EmitterPoint samplePoint(const EmitterPart& part, const Receiver& at, double u, double v) noexcept {
    return part.form == EmitterPart::Form::triangle ? sampleTriangle(part, at, u, v)
                                                    : sampleCapOf(part, at, u, v);
}

float densityAt(const EmitterPart& triangle, const Receiver& at, const Vec3f& position) noexcept {
    if (isNear(triangle, at)) {
        const LitPolygonSampler near(
            aboveHorizon(seenFrom(triangle, Vec3d(at.position)), Vec3d(at.normal)));
        if (near.solidAngle() > 0) return static_cast<float>(1 / near.solidAngle());
    }
    return densityByArea(triangle, position - at.position);
}

std::optional<LampHit> meetLamp(const EmitterPart& part, const Receiver& at,
                                const Vec3f& direction) noexcept {
    if (part.form == EmitterPart::Form::triangle) return meetTriangle(part, at, direction);
    const Cap cap = capOf(part, at);
    const Vec3d unit(direction);
    if (!isInCap(cap.axis, cap.sineSquared, unit)) return {};
    return LampHit{static_cast<float>(cap.distance / unit.dot(cap.axis)),
                   part.radiance * static_cast<float>(shareTowards(part, unit)),
                   static_cast<float>(1 / capSolidAngle(cap.sineSquared))};
}

}  // namespace shadowcache
