#pragma once

#include <cstdint>

#include "common/math/vec.h"

namespace shadowcache {

class Scene;

/// Where a ray meets the set, relative to the mesh's origin.
struct Hit {
    bool found = false;
    const Scene* scene = nullptr;  ///< whose triangle it is: the one asked, or what moves in it
    Vec3f position{0};             ///< on the triangle, from its corners
    Vec3f normal{0};               ///< unit geometric normal, by the triangle's winding
    float distance = 0;            ///< along the ray
    std::uint32_t triangle = 0;    ///< its number in the world (placed_mesh.h)
    float u = 0, v = 0;            ///< barycentric coordinates of the second and third corner
    float weight = 1;              ///< of light from a pane: makes up for rays that pass it
    Rgb tint{1.0f, 1.0f, 1.0f};    ///< by panes on the way; where nothing is found, to the sky
    float share = 1;    ///< of look(): what the ray counts as in place of one, on the mean 1
    float covered = 0;  ///< of look(): chance that such a ray meets the set
};

}  // namespace shadowcache
