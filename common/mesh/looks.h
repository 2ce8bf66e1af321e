#pragma once

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

/// Whether a cut-out material has a hole there.
bool isHole(const TriangleMesh& mesh, const Material& material, std::uint32_t triangle, float u,
            float v) noexcept;

}  // namespace shadowcache
