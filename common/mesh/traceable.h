#pragma once

#include <string>

#include "common/mesh/mesh.h"

namespace shadowcache {

/// Refuses instances that rays cannot be traced against: beyond kMostCoordinate of the mesh's
/// origin, or so small that rays brought into their space leave Embree's range. Instances that are
/// flat are hidden and may have any size.
///
/// @param owner  begins the message: the file, and the frame if there are several
/// @throws Error naming the owner, the instance, what was found and what is expected
void requireTraceable(const TriangleMesh& mesh, const std::string& owner);

}  // namespace shadowcache
