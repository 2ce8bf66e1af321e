#pragma once

#include <vector>

#include "common/import/mesh_reader.h"

namespace shadowcache {

/// Gives the vertices of a mesh the colours of its faces; those that faces of several colours share
/// are split. Where the vertices have colours of their own, these stay, and RawMesh::leftOut names
/// those of the faces.
///
/// @param colors  linear, of the first faces, one each; others are kUncolored
void colorFaces(const std::vector<Rgb>& colors, RawMesh& mesh);

}  // namespace shadowcache
