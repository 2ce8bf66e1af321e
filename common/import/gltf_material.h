#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/mesh/material.h"
#include "common/mesh/mesh.h"

namespace shadowcache {

class GltfObject;

/// Where on a surface a texture lies.
struct GltfTexturePlace {
    int texcoordSet = 0;
    Vec3d toS{1, 0, 0};  ///< texture coordinate s is the dot product of this and (u, v, 1)
    Vec3d toT{0, 1, 0};

    bool operator==(const GltfTexturePlace&) const = default;
};

/// A material, and where on the surface its textures lie.
struct GltfMaterial {
    std::string name;
    Material material;                     ///< its textures are indices into GltfDocument::textures
    std::vector<GltfTexturePlace> places;  ///< by layer of the material's slots
    /// The opacity of the texture of metalness and roughness is a glossiness, times this.
    std::optional<float> glossiness;
    bool clamped = false;              ///< a factor was out of range or not finite
    std::vector<std::string> leftOut;  ///< what the file asks for and this program has not
};

/// Counts a thing by its cause and name, up to a number of names for all.
void nameOne(const std::string& kind, const std::string& cause, const std::string& name,
             LeftOutOf& leftOut);

/// Names a material of opacity 0, of which nothing is seen.
void nameIfInvisible(const GltfMaterial& material, LeftOutOf& leftOut);

/// A material of a file; factors out of range are brought into it.
///
/// @param textures  number of the file's
/// @throws Error naming the material: no such texture, a member of another kind
GltfMaterial gltfMaterial(const GltfObject& from, std::size_t textures);

}  // namespace shadowcache
