#pragma once

#include <array>
#include <vector>

#include "common/predict/radiosity_tree.h"

namespace shadowcache {

/// How near places draw the directions of their diffuse rays: by the cosine, or, with a share of
/// them, toward balls that send them much light. As it is made: all by the cosine.
class DirectionGuide {
public:
    struct Part {
        RadiosityTree::Ball ball;
        float chance;  ///< with which a guided ray goes there; they sum to 1
    };

    DirectionGuide() = default;
    bool isCosine() const { return share_ <= 0; }
    /// @param share  of rays that are guided, in (0, 1)
    DirectionGuide(std::vector<Part> parts, float share);

    struct Drawn {
        Vec3f direction;       ///< unit; below the horizon nothing lights the place
        int part = kByCosine;  ///< number of the ball that it goes to
    };
    static constexpr int kByCosine = -1;

    /// Direction of a ray.
    ///
    /// @param normal   unit
    /// @param numbers  in [0, 1)
    Drawn draw(const Vec3f& origin, const Vec3f& normal, const std::array<float, 2>& numbers) const;

    /// Density with which draw() takes a direction above the horizon [1/sr], times pi: by the
    /// cosine that is the cosine.
    ///
    /// @param direction  unit
    /// @param part       whose ball holds the direction for sure, as that drew it; kByCosine: none
    float density(const Vec3f& origin, float cosine, const Vec3f& direction,
                  int part = kByCosine) const;

private:
    std::vector<Part> parts_;
    float share_ = 0;
};

/// The directions of a ball from a place outside of it.
struct BallCone {
    Vec3f axis{0};     ///< unit
    float height = 0;  ///< 1 - cosine of half its angle; 0: the place is in the ball, or next to it

    BallCone(const RadiosityTree::Ball& ball, const Vec3f& origin);
    bool empty() const { return height <= 0; }
    bool holds(const Vec3f& direction) const {
        return (direction - axis).length2() <= 2 * height;  // 2 - 2 cosine of their angle
    }
    float solidAngle() const { return 2 * static_cast<float>(kPi) * height; }
    /// @param u, v  in [0, 1)
    Vec3f draw(float u, float v) const;
};

}  // namespace shadowcache
