#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/mesh/material.h"

namespace tinygltf {
struct Material;
}

namespace shadowcache {

/// Where on a surface a texture lies.
struct GltfTexturePlace {
    int texcoordSet = 0;
    Vec3f toS{1, 0, 0};  ///< texture coordinate s is the dot product of this and (u, v, 1)
    Vec3f toT{0, 1, 0};

    bool operator==(const GltfTexturePlace&) const = default;
};

/// A material, and where on the surface its textures lie.
struct GltfMaterial {
    Material material;                     ///< its textures are indices into GltfDocument::textures
    std::vector<GltfTexturePlace> places;  ///< by layer of the material's slots
    /// The opacity of the texture of metalness and roughness is a glossiness, times this.
    std::optional<float> glossiness;
    bool clamped = false;              ///< a factor was out of range or not finite
    std::vector<std::string> leftOut;  ///< what the file asks for and this program has not
};

/// A material of a file; factors out of range are brought into it.
///
/// @param textures  number of the file's
/// @throws Error naming the file: no such texture, a factor of the wrong size
GltfMaterial gltfMaterial(const std::filesystem::path& path, const tinygltf::Material& from,
                          std::size_t textures);

}  // namespace shadowcache
