#pragma once

#include "common/mesh/mesh.h"

namespace shadowcache {

struct SurfaceCount;

/// Spacing that gives a set of this surface and extent a sensible number of items, fewer in
/// clutter.
///
/// @param count  receives the set's surface in such voxels, unless null
double chooseSpacing(const TriangleMesh& mesh, SurfaceCount* count = nullptr);

}  // namespace shadowcache
