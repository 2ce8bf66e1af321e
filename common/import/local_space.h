#pragma once

#include "common/import/mesh_reader.h"

namespace shadowcache {

/// Brings the vertices of groups that lie far from their own origin near it, and to a size of about
/// 1 those that are far from it: rays are traced in the space of a group, in float. Its instances
/// bring them back (RawInstance::toGroup).
void bringNearOrigin(RawMesh& raw);

}  // namespace shadowcache
