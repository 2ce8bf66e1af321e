#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/import/gltf_document.h"
#include "common/import/gltf_nodes.h"

namespace shadowcache {

/// A mesh in the form that morph targets and a skin give it.
struct GltfShape {
    int mesh = -1;
    std::vector<double> weights;  ///< of its morph targets, from the first on; others are 0
    std::vector<Affine> joints;   ///< from the mesh to the world, by joint; empty: it has no skin
};

/// A copy of a shape in the world.
struct GltfPlacement {
    int node = -1;
    std::size_t shape = 0;  ///< of GltfPose::shapes
    Affine inNode;          ///< from the shape to its node: what EXT_mesh_gpu_instancing says
    Affine toWorld;         ///< nothing for a skin, whose joints lead to the world
};

/// Nodes with meshes at a time.
struct GltfPose {
    std::vector<GltfShape> shapes;
    std::vector<GltfPlacement> placements;  ///< in order of the nodes
};

/// @param which  nodes with a mesh each
/// @throws Error naming the file and the node: a transform that is not finite, instances or inverse
/// bind matrices that do not fit together
GltfPose poseOf(const GltfDocument& document, const GltfNodes& nodes, std::span<const int> which,
                double seconds);

}  // namespace shadowcache
