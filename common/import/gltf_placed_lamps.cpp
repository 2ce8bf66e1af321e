#include "common/import/gltf_placed_lamps.h"

#include "common/import/lamp_place.h"

namespace shadowcache {

std::vector<Lamp> gltfLamps(const GltfDocument& document, const GltfNodes& nodes,
                            std::optional<double> stillAt, LeftOutOf& leftOut) {
    std::vector<Lamp> lamps;
    for (int i = 0; i < static_cast<int>(document.nodes.size()); ++i) {
        const GltfNode& node = document.nodes[static_cast<std::size_t>(i)];
        if (!node.inScene || node.light < 0) continue;
        if (!stillAt && nodes.moves(i)) {
            ++leftOut[{"light", "node moves, and is left out"}];
            continue;
        }
        const Lamp& light = document.lights[static_cast<std::size_t>(node.light)];
        std::optional<Lamp> lamp = placedLamp(light, nodes.at(i, stillAt.value_or(0)));
        if (!lamp) {
            ++leftOut[{"light", "node has no direction, and is left out"}];
            continue;
        }
        if (!node.name.empty()) lamp->name = node.name;
        lamps.push_back(*std::move(lamp));
    }
    return lamps;
}

}  // namespace shadowcache
