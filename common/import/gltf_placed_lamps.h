#pragma once

#include <optional>
#include <vector>

#include "common/import/gltf_nodes.h"
#include "common/mesh/lamp.h"

namespace shadowcache {

/// The lamps of the scene's nodes, in the file's world.
///
/// @param stillAt  time at which everything stands still [s]; none: those that move are left out,
/// and counted in `leftOut`
std::vector<Lamp> gltfLamps(const GltfDocument& document, const GltfNodes& nodes,
                            std::optional<double> stillAt, LeftOutOf& leftOut);

}  // namespace shadowcache
