#pragma once

#include <array>

#include "common/math/spherical_triangle.h"
#include "common/math/vec.h"

namespace shadowcache {

// Light of an emitting triangle at a place: its irradiance in closed form, and directions to
// sample. Corners are relative to the place; n is the unit normal there.
// Lamps: lit_cap.h; of any part: irradianceBy() of emitter_part.h.

/// The part of a triangle above the horizon of a place.
struct LitPolygon {
    std::array<Vec3d, 4> corner{};
    int corners = 0;  ///< 0: none of it is; else 3 or 4
};

/// Clips a triangle to the plane through the place. [Arvo 1995]
LitPolygon aboveHorizon(const std::array<Vec3d, 3>& triangle, const Vec3d& n) noexcept;

/// The integral of the cosine over the directions to a polygon, from whichever side: irradiance by
/// a radiance of 1 if nothing is in the way, 0 to pi. [Lambert 1760; Arvo 1995]
double cosineIntegral(const LitPolygon& polygon, const Vec3d& n) noexcept;

/// Directions to a polygon, uniform in solid angle.
class LitPolygonSampler {
public:
    explicit LitPolygonSampler(const LitPolygon& polygon) noexcept;

    /// Of the polygon [sr]; 0 where it has no extent as seen from the place.
    double solidAngle() const { return area_[0] + area_[1]; }
    /// A unit vector with density 1 / solidAngle(), which must be above 0. @param u, v  in [0, 1)
    Vec3d sample(double u, double v) const noexcept;

private:
    std::array<SphericalTriangle, 2> part_{};
    std::array<double, 2> area_{0, 0};
};

}  // namespace shadowcache
