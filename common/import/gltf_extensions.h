#pragma once

#include <string>
#include <vector>

#include "common/mesh/mesh.h"

namespace tinygltf {
class Model;
}

namespace shadowcache {

/// Whether a file that requires the extension is read: all of it, or, of a material, without it,
/// which the report then says.
bool mayRequireGltfExtension(const std::string& name);

/// Whether what the extension says of a material is read.
bool isReadOfMaterials(const std::string& name);

/// Counts the extensions of nodes, meshes, primitives, cameras, the scene and the file as a whole
/// that are left out; of nodes and what they show, those of the scene.
///
/// @param inScene  by node
void countLeftOut(const tinygltf::Model& model, const std::vector<bool>& inScene,
                  LeftOutOf& leftOut);

}  // namespace shadowcache
