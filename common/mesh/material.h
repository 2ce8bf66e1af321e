#pragma once

#include <cstdint>
#include <vector>

#include "common/math/vec.h"

namespace shadowcache {

/// Picture on surfaces: 8 bits a channel, colour sRGB-encoded, opacity linear; row 0 at t = 0.
struct Texture {
    enum class Wrap { repeat, mirror, clamp };

    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> rgba;
    Wrap wrapS = Wrap::repeat;
    Wrap wrapT = Wrap::repeat;
    bool smooth = true;  ///< bilinear; else the nearest texel
};

/// How the triangles of a part look, and where they are holes.
struct Material {
    Rgb albedo{1.0f, 1.0f, 1.0f};
    int texture = -1;      ///< of TriangleMesh::textures, times the albedo; -1: none
    bool cutOut = false;   ///< holes where the opacity is below `cutoff`
    float opacity = 1.0f;  ///< times the texture's
    float cutoff = 0.5f;
    bool doubleSided = true;  ///< else the camera does not see its back; shadows it casts anyway
};

/// Linear colour at texture coordinates (s, t).
Rgb textureColor(const Texture& texture, float s, float t) noexcept;

/// Opacity at texture coordinates (s, t), 0 to 1.
float textureOpacity(const Texture& texture, float s, float t) noexcept;

}  // namespace shadowcache
