#pragma once

#include <optional>
#include <vector>

#include "common/import/gltf_nodes.h"
#include "common/mesh/lamp.h"

namespace shadowcache {

/// The lamps of the scene's nodes that stand still, in the file's world.
///
/// @param stillAt  time at which all of them do [s]
/// @param leftOut  counts those without a direction
std::vector<Lamp> gltfLamps(const GltfDocument& document, const GltfNodes& nodes,
                            std::optional<double> stillAt, LeftOutOf& leftOut);

/// Nodes of the scene with a lamp.
std::vector<int> lampNodes(const GltfDocument& document);

/// The same, of those that an animation moves.
std::vector<int> movingLampNodes(const GltfDocument& document, const GltfNodes& nodes);

/// A node's lamp in the node's own axes.
///
/// @param node  with a lamp
Lamp gltfLampOf(const GltfDocument& document, int node);

/// A lamp in the file's world at a time.
struct GltfLampPlace {
    Lamp lamp;
    bool isThere = false;  ///< it has a direction and, if it moves, a size
};

/// @param node  with a lamp
GltfLampPlace gltfLampAt(const GltfDocument& document, const GltfNodes& nodes, int node,
                         double seconds);

}  // namespace shadowcache
