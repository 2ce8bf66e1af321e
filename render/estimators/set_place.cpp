#include "render/estimators/set_place.h"

#include "common/mesh/placed_mesh.h"
#include "common/mesh/shading_normal.h"

namespace shadowcache {

Surface surfaceOf(const Hit& hit, const PlainLook& plain) {
    const TriangleMesh& mesh = hit.scene->mesh();
    const Surface surface =
        surfaceAt(mesh, placedTriangle(mesh, hit.triangle).triangle, hit.u, hit.v, plain);
    return hit.weight == 1 ? surface : scaled(surface, Rgb(hit.weight));
}

Surface surfaceSeen(const Hit& hit, const PlainLook& plain) {
    return scaled(surfaceOf(hit, plain), hit.tint * hit.share);
}

Vec3f rayStartOf(const Scene& scene, const View& view) {
    const Hit& hit = view.hit;
    const Vec3f side = view.geometricNormal();
    const Vec3f onSurface = hit.scene->rayOrigin(hit.position, hit.triangle, side);
    const Vec3f offset = smoothOffset(hit.scene->mesh(), hit.triangle, hit.u, hit.v, side);
    // On flat parts it is less than what keeps rays off the surface.
    if (offset.length2() <= (onSurface - hit.position).length2()) return onSurface;
    return scene.isFree(onSurface, offset) ? onSurface + offset : onSurface;
}

}  // namespace shadowcache
