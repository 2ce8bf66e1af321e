#pragma once

#include <string>

#include "common/math/affine.h"
#include "common/mesh/mesh.h"

namespace shadowcache {

/// Whether an instance is so small that rays brought into its space leave Embree's range. Those
/// that are flat are hidden and may have any size.
bool isTooSmall(const Affine& toWorld);

/// Refuses instances that rays cannot be traced against: beyond kMostCoordinate of the mesh's
/// origin, or too small.
///
/// @param owner  begins the message: the file, and the frame if there are several
/// @throws Error naming the owner, the instance, what was found and what is expected
void requireTraceable(const TriangleMesh& mesh, const std::string& owner);

}  // namespace shadowcache
