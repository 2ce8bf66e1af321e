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

/// Least width of a spot's falloff, in the cosine: of the square [KHR_lights_punctual], and of
/// Blender's, which may have an edge.
constexpr double kLeastFalloff = 0.001, kEdge = 1e-9;

/// Weight of what a spot sends at most to a place that its cone grazes, and an area to one that its
/// slats hide in part: no direction is missed.
constexpr double kLeastConeShare = 0.05;

/// Change over half of a triangle of what slats leave, as a share of the most, up to which a few of
/// its points tell it.
constexpr float kSlight = 0.5f;

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
    const double width =
        std::max(cone.cosInner - cone.cosOuter, cone.smooth ? kEdge : kLeastFalloff);
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

/// What an area's slats leave of its radiance towards a place, along a way to it of any length.
double slatShare(const EmitterPart& t, const Vec3d& way) {
    if (t.slats == 0) return 1;
    const Vec3d normal(t.normal);
    const double front = -normal.dot(way);
    if (!(front > 0)) return 0;
    const double aside = (way + normal * front).length();
    return std::max(0.0, 1 - static_cast<double>(t.slats) * aside / front);
}

std::array<Vec3d, 3> seenFrom(const EmitterPart& t, const Vec3d& place) {
    return {Vec3d(t.corner[0]) - place, Vec3d(t.corner[1]) - place, Vec3d(t.corner[2]) - place};
}

/// Whether slats may hide some of a triangle that shines to the side of a place.
bool isHiddenInPart(const EmitterPart& t, const Receiver& at) noexcept {
    if (t.slats == 0) return false;
    const Vec3f way = t.centre - at.position;
    const float front = -t.normal.dot(way);
    return t.slats * ((way + t.normal * front).length() + t.radius) > front;
}

/// The part of a triangle that may light a place: above its horizon, and where slats hide some of
/// it in the square around what they leave.
LitPolygon litPart(const EmitterPart& t, const Receiver& at) noexcept {
    LitPolygon lit = aboveHorizon(seenFrom(t, Vec3d(at.position)), Vec3d(at.normal));
    if (!isHiddenInPart(t, at)) return lit;
    const Vec3d normal(t.normal);
    Vec3d s, u;
    tangentFrame(normal, s, u);
    const auto slats = static_cast<double>(t.slats);
    for (const Vec3d& side : {s, -s, u, -u})
        if (lit.corners > 0) lit = clipped(lit, side * -slats - normal);
    return lit;
}

/// Mean of what slats leave of the parts of a polygon by what they light a place with, about.
double meanSlatShare(const EmitterPart& t, const LitPolygon& polygon, const Vec3d& n) {
    const auto corners = static_cast<std::size_t>(polygon.corners);
    Vec3d middle(0, 0, 0);
    for (std::size_t i = 0; i < corners; ++i)
        middle += polygon.corner[i] / static_cast<double>(corners);
    double all = 0, left = 0;
    for (std::size_t i = 0; i < corners; ++i) {
        const Vec3d &a = polygon.corner[i], &b = polygon.corner[i + 1 < corners ? i + 1 : 0];
        const double area = (a - middle).cross(b - middle).length();
        for (const Vec3d& way : {(a + b) * 0.5, (b + middle) * 0.5, (a + middle) * 0.5}) {
            const double squared = way.length2();
            if (!(squared > 0)) continue;
            const double light = area * std::max(0.0, n.dot(way)) / (squared * squared);
            all += light;
            left += light * slatShare(t, way);
        }
    }
    return all > 0 ? left / all : 0;
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
        float light = (at.normal.dot(way) / squared) * (front / squared);
        if (t.slats > 0) light *= static_cast<float>(slatShare(t, Vec3d(way)));
        sum += light;
    }
    return sum * t.area * (1.0f / 3);
}

/// Distance of a point on a triangle's plane from the triangle.
float distanceFrom(const EmitterPart& t, const Vec3f& point) noexcept {
    float nearest = std::numeric_limits<float>::max();
    bool left = true, right = true;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3f side = t.corner[(i + 1) % 3] - t.corner[i], way = point - t.corner[i];
        const float turn = t.normal.dot(side.cross(way));
        left = left && turn >= 0;
        right = right && turn <= 0;
        const float along = std::clamp(way.dot(side) / side.length2(), 0.0f, 1.0f);
        nearest = std::min(nearest, (way - side * along).length2());
    }
    return left || right ? 0 : std::sqrt(nearest);
}

/// An irradiance with what slats leave of it, about.
///
/// @param integral  by a radiance of 1 without them
/// @param mean      share of it that they leave, about
Unoccluded throughSlats(const EmitterPart& t, const Receiver& at, float integral, float mean) {
    const float least = slatShareOf(t, at.position);
    return {t.radiance * (integral * mean), t.weight * integral * std::max(mean, least)};
}

Unoccluded irradianceByTriangle(const EmitterPart& t, const Receiver& at) noexcept {
    const Vec3f way = t.centre - at.position;
    const float front = -t.normal.dot(way);
    if (front == 0 || (front < 0 && !t.twoSided)) return {};
    const float height = at.normal.dot(way), squared = way.length2();
    if (isBelow(height, t.radius)) return {};
    if (squared > kFarTriangleRadii * kFarTriangleRadii * t.radius * t.radius &&
        std::abs(height) > t.radius && hasSlightSlats(t, at.position, t.radius)) {
        if (height < 0) return {};
        const float integral = irradianceByFar(t, at, std::abs(front));
        return {t.radiance * integral, t.slats > 0 ? roughWeightBy(t, at) : t.weight * integral};
    }
    const Vec3d n(at.normal);
    const LitPolygon polygon = litPart(t, at);
    if (polygon.corners == 0) return {};
    // However thin the part above the horizon is, a sample may meet it.
    const auto integral = static_cast<float>(std::max(cosineIntegral(polygon, n), 1e-12));
    if (t.slats > 0)
        return throughSlats(t, at, integral, static_cast<float>(meanSlatShare(t, polygon, n)));
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

/// Whether a triangle is so narrow that rounding decides how its corners lie.
bool isThin(const EmitterPart& t) noexcept {
    constexpr double kRounding = 0x1p-20;
    double far = 0;
    for (const Vec3f& corner : t.corner) far = std::max(far, Vec3d(corner).length());
    const double twiceArea = (Vec3d(t.corner[1]) - Vec3d(t.corner[0]))
                                 .cross(Vec3d(t.corner[2]) - Vec3d(t.corner[0]))
                                 .length();
    return twiceArea < kRounding * far * static_cast<double>(t.size);
}

/// Whether points of a triangle are drawn in solid angle.
bool isNear(const EmitterPart& t, const Receiver& at) noexcept {
    return ((t.centre - at.position).length2() < kNear * kNear * t.size * t.size ||
            isHiddenInPart(t, at)) &&
           !isThin(t);
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
    if (isNear(t, at)) near.emplace(litPart(t, at));
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
    point.share = static_cast<float>(slatShare(t, on.way));
    return point;
}

std::optional<LampHit> meetTriangle(const EmitterPart& t, const Receiver& at,
                                    const Vec3f& direction) noexcept {
    if (!isLit(t, at)) return {};
    const OnPlane on = onPlane(seenFrom(t, Vec3d(at.position)), Vec3d(direction));
    const double distance = on.way.dot(Vec3d(direction));
    const double third = 1 - on.u - on.v;
    if (!(distance > 0) || !(std::min({on.u, on.v, third}) >= -kOverlap)) return {};
    return LampHit{static_cast<float>(distance),
                   t.radiance * static_cast<float>(slatShare(t, on.way)),
                   densityAt(t, at, at.position + Vec3f(on.way))};
}

}  // namespace

bool hasSlightSlats(const EmitterPart& triangle, const Vec3f& place, float radius) noexcept {
    return triangle.slats == 0 ||
           triangle.slats * radius < kSlight * -triangle.normal.dot(triangle.centre - place);
}

float slatShareOf(const EmitterPart& triangle, const Vec3f& place) noexcept {
    if (triangle.slats == 0) return 1;
    constexpr float kRounding = 1e-5f;
    const float front = -triangle.normal.dot(triangle.centre - place);
    if (!(front > 0)) return 0;
    const Vec3f foot = place - triangle.normal * front;
    const float aside = (triangle.centre - foot).length();
    const float nearest =
        distanceFrom(triangle, foot) - kRounding * (front + aside + triangle.radius);
    const float most = 1 - triangle.slats * std::max(0.0f, nearest) / front;
    if (!(most > 0)) return 0;
    return std::max(1 - triangle.slats * aside / front, static_cast<float>(kLeastConeShare) * most);
}

Unoccluded irradianceBy(const EmitterPart& part, const Receiver& at) noexcept {
    return part.form == EmitterPart::Form::triangle ? irradianceByTriangle(part, at)
                                                    : irradianceByCap(part, at);
}

float roughWeightBy(const EmitterPart& part, const Receiver& at) noexcept {
    if (part.form == EmitterPart::Form::triangle) {
        const Vec3f way = part.centre - at.position;
        const float squared = way.length2();
        if (squared > kRoughRadii * kRoughRadii * part.radius * part.radius &&
            hasSlightSlats(part, at.position, part.radius)) {
            const float front = -part.normal.dot(way);
            if (front == 0 || (front < 0 && !part.twoSided)) return 0;
            const float height = meanHeight(at.normal.dot(way), part.radius);
            return part.weight * part.area * (std::abs(front) / squared) * (height / squared) *
                   slatShareOf(part, at.position);
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
        const LitPolygonSampler near(litPart(triangle, at));
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
