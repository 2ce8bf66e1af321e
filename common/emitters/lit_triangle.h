#pragma once

#include <array>

#include "common/math/spherical_triangle.h"
#include "common/math/vec.h"

namespace shadowcache {

// Light of an emitting triangle at a place: its irradiance in closed form, and directions to
// sample. Corners are relative to the place; n is the unit normal there.
// Lamps: lit_cap.h; of any part: irradianceBy() of emitter_part.h.

/// The part of a triangle that may light a place.
struct LitPolygon {
    /// Of a triangle that five planes clip: a horizon, and four around what slats leave.
    static constexpr int kMostCorners = 8;

    std::array<Vec3d, kMostCorners> corner{};
    int corners = 0;  ///< 0: there is none; else 3 or more
};

/// Clips a triangle to the plane through the place. [Arvo 1995]
LitPolygon aboveHorizon(const std::array<Vec3d, 3>& triangle, const Vec3d& n) noexcept;

/// Clips what is left of a triangle to one more plane through the place, to the side of n, which
/// may have any length.
LitPolygon clipped(const LitPolygon& polygon, const Vec3d& n) noexcept;

/// The integral of the cosine over the directions to a polygon, from whichever side: irradiance by
/// a radiance of 1 if nothing is in the way, 0 to pi. [Lambert 1760; Arvo 1995]
double cosineIntegral(const LitPolygon& polygon, const Vec3d& n) noexcept;

/// Directions to a polygon, uniform in solid angle.
class LitPolygonSampler {
public:
    explicit LitPolygonSampler(const LitPolygon& polygon) noexcept;

    /// Of the polygon [sr]; 0 where it has no extent as seen from the place.
    double solidAngle() const { return solidAngle_; }
    /// A unit vector with density 1 / solidAngle(), which must be above 0. @param u, v  in [0, 1)
    Vec3d sample(double u, double v) const noexcept;

private:
    static constexpr int kMostParts = LitPolygon::kMostCorners - 2;

    std::array<SphericalTriangle, kMostParts> part_;  ///< the first parts_ of them
    std::array<double, kMostParts> area_;
    std::size_t parts_ = 0;
    double solidAngle_ = 0;
};

}  // namespace shadowcache
