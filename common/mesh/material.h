#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/math/vec.h"
#include "common/surface/surface.h"

namespace shadowcache {

/// Place on a picture.
using Vec2f = Imath::V2f;

/// Picture on surfaces: 8 or 16 bits a channel, colour sRGB-encoded, all else linear; row 0 at t =
/// 0. Opacity is that of the upper 8 bits.
struct Texture {
    enum class Wrap { repeat, mirror, clamp };

    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> rgba;  ///< the upper 8 of 16 bits
    std::vector<std::uint8_t> low;   ///< the lower 8, as many; none of 8 bits
    Wrap wrapS = Wrap::repeat;
    Wrap wrapT = Wrap::repeat;
    bool smooth = true;  ///< bilinear; else the nearest texel
};

/// A texture, and the texture coordinates that place it.
struct TextureSlot {
    int texture = -1;  ///< of TriangleMesh::textures; -1: none
    int layer = 0;     ///< 0: TriangleMesh::texcoords, else one less of moreTexcoords
};

/// What a material has besides its base colour; nothing makes a Lambertian surface.
struct Finish {
    std::optional<Gloss> gloss;
    TextureSlot metallicRoughness;   ///< green times the roughness, blue times metallic
    TextureSlot specular;            ///< opacity times the specular strength
    TextureSlot specularColor;       ///< colour times the specular colour
    Rgb emission{0.0f, 0.0f, 0.0f};  ///< [radiance]
    TextureSlot emissionTexture;     ///< colour times the emission
    Rgb gain{1.0f, 1.0f, 1.0f};      ///< times the emission
    float transmission = 0;          ///< share of the base that light passes straight, tinted by it
    TextureSlot transmissionTexture;  ///< red times the transmission
    bool unlit = false;               ///< emits its base colour and reflects nothing
};

/// How the triangles of a part look, and where they are holes.
struct Material {
    std::string name;
    Rgb albedo{1.0f, 1.0f, 1.0f};  ///< base colour
    int texture = -1;              ///< as a slot's, of layer 0; times the albedo
    TextureSlot normal;            ///< of a normal map
    float normalScale = 1;         ///< of its parts along the surface
    Finish finish;
    bool cutOut = false;   ///< holes where the opacity is below `cutoff`
    bool blends = false;   ///< lets light and looks pass with probability 1 - opacity
    float opacity = 1.0f;  ///< times the texture's
    float cutoff = 0.5f;
    bool doubleSided = true;  ///< else the camera does not see its back; shadows it casts anyway

    bool isPane() const { return finish.transmission > 0; }
    /// Whether rays pass it, each by a chance of its own.
    bool passesByChance() const { return blends || isPane(); }
    /// Whether rays pass it anywhere.
    bool isPierced() const { return cutOut || passesByChance(); }
};

/// Numbers of all its textures, -1 for none.
inline std::array<int*, 7> texturesOf(Material& m) {
    Finish& finish = m.finish;
    return {&m.texture,
            &m.normal.texture,
            &finish.metallicRoughness.texture,
            &finish.specular.texture,
            &finish.specularColor.texture,
            &finish.emissionTexture.texture,
            &finish.transmissionTexture.texture};
}

/// Linear colour at texture coordinates (s, t).
Rgb textureColor(const Texture& texture, float s, float t) noexcept;

/// The four channels at texture coordinates (s, t) as they are stored, 0 to 1.
std::array<float, 4> textureValue(const Texture& texture, float s, float t) noexcept;

/// Opacity at texture coordinates (s, t), 0 to 1.
float textureOpacity(const Texture& texture, float s, float t) noexcept;

}  // namespace shadowcache
