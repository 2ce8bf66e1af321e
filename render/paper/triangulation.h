#pragma once

#include <vector>

#include "common/light/environment.h"
#include "common/math/spherical_triangle.h"

namespace shadowcache {

/// Triangle of an adaptive triangulation of the sphere.
struct MapTriangle {
    int level;
    std::uint32_t cell;
    SphericalTriangle corners;
    Vec3d axis;     ///< unit, at the middle
    double radius;  ///< angle around the axis that holds the triangle [rad]
    double sinRadius;
    double area;               ///< [sr]
    Vec3d firstMoment;         ///< integral of luminance times direction
    double luminanceIntegral;  ///< integral of the luminance
    double floor;  ///< least luminanceIntegral to assume: positive wherever there is light
};

/// Splits the icosahedron to `minLevel`, then, always the triangle over which the luminance varies
/// most, until there are `count` (>= 20) triangles or none below `maxLevel` (0 .. 7); starts
/// coarser where `count` is less than minLevel has. [paper 4.4]
std::vector<MapTriangle> triangulateMap(const Environment& environment, int count, int minLevel,
                                        int maxLevel);

}  // namespace shadowcache
