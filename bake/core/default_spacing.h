#pragma once

#include "bake/core/options.h"
#include "common/mesh/mesh.h"

namespace shadowcache {

struct SurfaceCount;

/// Rays of a bake of some quality, as a multiple of those of a good one.
double rayFactor(BakeQuality quality);
/// Its spacing, likewise: items, and so rays, are in inverse proportion to the square of it.
double spacingFactor(BakeQuality quality);

/// Spacing that gives a set of this surface and extent a sensible number of items, fewer in
/// clutter.
///
/// @param count  receives the set's surface in such voxels, unless null
double chooseSpacing(const TriangleMesh& mesh, SurfaceCount* count = nullptr);

}  // namespace shadowcache
