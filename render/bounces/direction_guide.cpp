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
    height = sine * sine / (1 + std::sqrt(1 - sine * sine));
}

Vec3f BallCone::draw(float u, float v) const {
    // By 1 - cosine, which a narrow cone's cosine would round.
    const float below = u * height;
    const float sine = std::sqrt(below * (2 - below)), phi = 2 * static_cast<float>(kPi) * v;
    Vec3f s, t;
    tangentFrame(axis, s, t);
    return s * (sine * std::cos(phi)) + t * (sine * std::sin(phi)) + axis * (1 - below);
}

DirectionGuide::DirectionGuide(std::vector<Part> parts, float share)
    : parts_(std::move(parts)), share_(share) {}

DirectionGuide::Drawn DirectionGuide::draw(const Vec3f& origin, const Vec3f& normal,
                                           const std::array<float, 2>& numbers) const {
    float u = numbers[0];
    if (u < share_) {
        u /= share_;
        std::size_t i = 0;
        for (; i + 1 < parts_.size() && u >= parts_[i].chance; ++i) u -= parts_[i].chance;
        u = std::min(u / parts_[i].chance, 1 - std::numeric_limits<float>::epsilon());
        const BallCone cone(parts_[i].ball, origin);
        if (!cone.empty()) return {cone.draw(u, numbers[1]), static_cast<int>(i)};
    } else if (share_ > 0) {
        u = (u - share_) / (1 - share_);
    }
    return {aroundNormal(normal, std::sqrt(1 - u), numbers[1])};
}

float DirectionGuide::density(const Vec3f& origin, float cosine, const Vec3f& direction,
                              int part) const {
    float byCosine = 1 - share_, guided = 0;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        const BallCone cone(parts_[i].ball, origin);
        if (cone.empty())
            byCosine += share_ * parts_[i].chance;
        else if (static_cast<int>(i) == part || cone.holds(direction))
            guided += parts_[i].chance / (2 * cone.height);
    }
    return byCosine * cosine + share_ * guided;
}

}  // namespace shadowcache
