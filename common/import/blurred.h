#pragma once

#include "common/import/mesh_soup.h"

namespace shadowcache {

/// Names triangles whose form, or whose light, is lost in what positions are rounded to at their
/// distance from the origin; with the precision that is left. (MeshReport::remarks)
void countBlurred(const Vec3d& origin, MeshSoup& soup);

}  // namespace shadowcache
