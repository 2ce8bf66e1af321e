#include "render/bounces/direction_guide.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "render/estimators/hemisphere.h"

namespace shadowcache {

namespace {

/// Nearer than so many radii a ball is all around a place.
constexpr float kLeastRadii = 1.05f;

/// Sine of half the angle of the narrowest cone: narrower ones gain nothing that rounding does not
/// take.
constexpr float kLeastSine = 0.02f;

}  // namespace

BallCone::BallCone(const RadiosityTree::Ball& ball, const Vec3f& origin) {
    const Vec3f way = ball.centre - origin;
    const float distance = way.length();
    if (!(distance > kLeastRadii * ball.radius)) return;
    const float sine = std::max(ball.radius / distance, kLeastSine);
    axis = way / distance;
    sineSquared = sine * sine;
    height = sineSquared / (1 + std::sqrt(1 - sineSquared));
}

Vec3f BallCone::draw(float u, float v) const {
    return aroundNormal(axis, 1 - u * height, v);
}

DirectionGuide::DirectionGuide(std::vector<Part> parts, float share)
    : parts_(std::move(parts)), share_(share) {}

Vec3f DirectionGuide::draw(const Vec3f& origin, const Vec3f& normal,
                           const std::array<float, 2>& numbers) const {
    float u = numbers[0];
    if (u < share_) {
        u /= share_;
        for (const Part& part : parts_) {
            if (u >= part.chance && &part != &parts_.back()) {
                u -= part.chance;
                continue;
            }
            u = std::min(u / part.chance, 1 - std::numeric_limits<float>::epsilon());
            const BallCone cone(part.ball, origin);
            if (!cone.empty()) return cone.draw(u, numbers[1]);
            break;
        }
    } else if (share_ > 0) {
        u = (u - share_) / (1 - share_);
    }
    return aroundNormal(normal, std::sqrt(1 - u), numbers[1]);
}

float DirectionGuide::density(const Vec3f& origin, float cosine, const Vec3f& direction) const {
    float byCosine = 1 - share_, guided = 0;
    for (const Part& part : parts_) {
        const BallCone cone(part.ball, origin);
        if (cone.empty())
            byCosine += share_ * part.chance;
        else if (cone.holds(direction))
            guided += part.chance / (2 * cone.height);
    }
    return byCosine * cosine + share_ * guided;
}

}  // namespace shadowcache
