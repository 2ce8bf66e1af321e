#pragma once

#include <span>

#include "common/import/gltf_document.h"
#include "common/import/mesh_reader.h"

namespace shadowcache {

/// A node with a mesh, and where it stands.
struct GltfPlacement {
    int node = -1;
    Affine toWorld;
};

/// The meshes of some nodes. Those of several nodes are kept once, with instances; with
/// `alwaysShared`, so are all others, and instances[i] is nodes[i].
///
/// @throws Error naming the file and the mesh: no positions, morphs, an armature, no picture
RawMesh gltfMesh(const GltfDocument& document, std::span<const GltfPlacement> nodes,
                 bool alwaysShared);

}  // namespace shadowcache
