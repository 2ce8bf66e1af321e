#pragma once

#include "common/math/vec.h"

namespace shadowcache {

// A lamp as a place sees it that it lights: directions within an angle of an axis, at most 90
// degrees, of which the squared sine is given.

/// Irradiance by a cap of directions, of radiance 1, over what it gives where its axis is the
/// normal (pi times the squared sine): 0 to 1. What is below the horizon gives nothing. Of a single
/// direction: its cosine, or 0. [Snyder 1996, "Area Light Sources for Real-Time Graphics";
/// Lagarde & de Rousiers 2014, Sec. 4.7]
///
/// @param cosine  between the axis and the normal
double capCosine(double cosine, double sineSquared) noexcept;

/// Solid angle of a cap [sr].
double capSolidAngle(double sineSquared) noexcept;

/// A unit vector of a cap, uniform in solid angle. @param u, v  in [0, 1)
Vec3d sampleCap(const Vec3d& axis, double sineSquared, double u, double v) noexcept;

/// Whether a direction is in a cap. @param direction  unit
bool isInCap(const Vec3d& axis, double sineSquared, const Vec3d& direction) noexcept;

}  // namespace shadowcache
