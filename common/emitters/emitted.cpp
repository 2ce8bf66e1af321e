#include "common/emitters/emitted.h"

#include "common/mesh/looks.h"
#include "common/mesh/placed_mesh.h"

namespace shadowcache {

Rgb emittedAt(const TriangleMesh& mesh, std::uint32_t triangle, float u, float v) noexcept {
    const Rgb emission = surfaceAt(mesh, triangle, u, v, {}).emission;
    const Material& material = *materialOf(mesh, triangle);
    return emission * opacityAt(mesh, material, triangle, u, v);
}

}  // namespace shadowcache
