#pragma once

#include "common/mesh/lamp.h"
#include "common/mesh/mesh.h"

namespace shadowcache {

class GltfObject;

/// Extension of glTF that has lamps.
inline constexpr const char* kGltfLights = "KHR_lights_punctual";

/// A light of KHR_lights_punctual, at the origin of its node, which it lights along -Z. `extras`
/// make it soft: "radius" [m] of points and spots, "angle" of directional lights [rad]; and a spot
/// an area: "shape" "rectangle" or "ellipse" with "size" [width, height] and Lamp::spread, "spread"
/// [rad]. "falloff" of a spot's cone is "square" [by default], or "smoothstep" or "smoothstep times
/// cosine", as Blender has it.
///
/// @param leftOut  counts what is not read
/// @throws Error naming the light: an intensity that is negative or too large, angles out of order
/// or range
Lamp gltfLamp(const GltfObject& light, LeftOutOf& leftOut);

}  // namespace shadowcache
