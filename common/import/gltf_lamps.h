#pragma once

#include <optional>
#include <vector>

#include "common/import/gltf_nodes.h"
#include "common/mesh/lamp.h"

namespace shadowcache {

/// Extension of glTF that has lamps.
inline constexpr const char* kGltfLights = "KHR_lights_punctual";

/// A light of KHR_lights_punctual, at the origin of its node, which it lights along -Z. `extras`
/// make it soft: "radius" [m] of points and spots, "angle" of directional lights [rad]; and a spot
/// an area: "shape" "rectangle" or "ellipse" with "size" [width, height]. "falloff" of a spot's
/// cone is "square" [by default], or "smoothstep" or "smoothstep times cosine", as Blender has it.
///
/// @param leftOut  counts what is not read
/// @throws Error naming the light: an intensity that is negative or too large, angles out of order
Lamp gltfLamp(const GltfObject& light, LeftOutOf& leftOut);

/// The lamps of the scene's nodes, in the file's world.
///
/// @param stillAt  time at which everything stands still [s]; none: those that move are left out,
/// and counted in `leftOut`
std::vector<Lamp> gltfLamps(const GltfDocument& document, const GltfNodes& nodes,
                            std::optional<double> stillAt, LeftOutOf& leftOut);

}  // namespace shadowcache
