#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/mesh/mesh.h"

namespace shadowcache {

// What a set looks like at a place: of TriangleMesh::triangles[triangle], at its barycentric
// coordinates (u, v).

/// What stands for a material where the files give none.
struct PlainLook {
    Rgb albedo{0.5f, 0.5f, 0.5f};  ///< where they give no colour
    std::optional<Gloss> gloss{};  ///< none: Lambertian
};

/// How light leaves the surface there.
Surface surfaceAt(const TriangleMesh& mesh, std::uint32_t triangle, float u, float v,
                  const PlainLook& plain) noexcept;

/// Linear base colour; `fallback` where the files give none.
Rgb albedoAt(const TriangleMesh& mesh, std::uint32_t triangle, float u, float v,
             const Rgb& fallback) noexcept;

/// The channels of a texture as they are stored.
///
/// @param slot  has a texture
std::array<float, 4> textureAt(const TriangleMesh& mesh, std::uint32_t triangle, float u, float v,
                               const TextureSlot& slot) noexcept;

/// Texture coordinates of a triangle's corners.
std::array<Vec2f, 3> texturePlaces(const TriangleMesh& mesh, std::uint32_t triangle,
                                   int layer) noexcept;

/// Opacity of a material there, 0 to 1; of one that is cut out 0 or 1.
float opacityAt(const TriangleMesh& mesh, const Material& material, std::uint32_t triangle, float u,
                float v) noexcept;

/// How rays pass a surface straight: through holes, what blends, and panes.
struct Passage {
    float stopped = 1;           ///< share of the rays that do not pass, 0 to 1
    Rgb tint{1.0f, 1.0f, 1.0f};  ///< factor of what those carry that pass
    float weight = 1;            ///< factor of what the surface sends to those that do not
};

/// Of a material there: its coverage, and of what is covered the light that a pane transmits.
///
/// @param cosine  between the ray and the triangle's normal, of any sign; for panes
Passage passageAt(const TriangleMesh& mesh, const Material& material, std::uint32_t triangle,
                  float u, float v, float cosine) noexcept;

/// Whether a pane of the material may tint what passes.
bool mayTint(const TriangleMesh& mesh, const Material& material) noexcept;

}  // namespace shadowcache
