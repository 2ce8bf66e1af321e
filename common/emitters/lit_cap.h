#pragma once

#include "common/math/vec.h"

namespace shadowcache {

// A lamp as a place sees it that it lights: directions within an angle of an axis, at most 90
// degrees, of which the squared sine is given.

/// The integral of the cosine over the directions of a cap that are above the horizon, as a share
/// of pi times the squared sine, which it is if the cap's axis is the normal: 0 to 1. Of a single
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
