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

/// Whether a cut-out material has a hole there, or one that blends lets a ray pass.
///
/// @param chance  in [0, 1), the ray's own: it passes with probability 1 - opacity
bool isHole(const TriangleMesh& mesh, const Material& material, std::uint32_t triangle, float u,
            float v, float chance) noexcept;

}  // namespace shadowcache
