#include "common/import/gltf_placed_lamps.h"

#include <algorithm>

#include "common/import/lamp_place.h"

namespace shadowcache {

std::vector<int> lampNodes(const GltfDocument& document) {
    std::vector<int> found;
    for (int i = 0; i < static_cast<int>(document.nodes.size()); ++i) {
        const GltfNode& node = document.nodes[static_cast<std::size_t>(i)];
        if (node.inScene && node.light >= 0) found.push_back(i);
    }
    return found;
}

Lamp gltfLampOf(const GltfDocument& document, int node) {
    const GltfNode& from = document.nodes[static_cast<std::size_t>(node)];
    Lamp lamp = document.lights[static_cast<std::size_t>(from.light)];
    if (!from.name.empty()) lamp.name = from.name;
    return lamp;
}

GltfLampPlace gltfLampAt(const GltfDocument& document, const GltfNodes& nodes, int node,
                         double seconds) {
    const Lamp lamp = gltfLampOf(document, node);
    const Affine place = nodes.at(node, seconds);
    const std::optional<Lamp> placed = placedLamp(lamp, place);
    const bool isThere = placed && (hasSize(place) || !nodes.moves(node));
    return {isThere ? *placed : lamp, isThere};
}

std::vector<Lamp> gltfLamps(const GltfDocument& document, const GltfNodes& nodes,
                            std::optional<double> stillAt, LeftOutOf& leftOut) {
    std::vector<Lamp> lamps;
    for (const int node : lampNodes(document)) {
        if (!stillAt && nodes.moves(node)) continue;
        GltfLampPlace found = gltfLampAt(document, nodes, node, stillAt.value_or(0));
        if (found.isThere)
            lamps.push_back(std::move(found.lamp));
        else if (!nodes.moves(node))
            ++leftOut[{"light", "node has no direction, and is left out"}];
    }
    return lamps;
}

std::vector<int> movingLampNodes(const GltfDocument& document, const GltfNodes& nodes) {
    std::vector<int> moving;
    for (const int node : lampNodes(document))
        if (nodes.moves(node)) moving.push_back(node);
    return moving;
}

}  // namespace shadowcache
