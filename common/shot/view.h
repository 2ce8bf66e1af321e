#pragma once

#include "common/mesh/normal_map.h"
#include "common/mesh/shading_normal.h"
#include "common/shot/camera.h"
#include "common/trace/scene.h"

namespace shadowcache {

/// What a camera ray meets.
struct View {
    Vec3f direction{0};
    Hit hit;

    /// Unit geometric normal of the place that was hit, on the viewer's side.
    Vec3f geometricNormal() const {
        return hit.normal.dot(direction) > 0 ? -hit.normal : hit.normal;
    }
    /// Unit shading normal there, on the same side of the surface.
    Vec3f shadingNormal() const {
        const TriangleMesh& mesh = hit.scene->mesh();
        const Vec3f side = geometricNormal();
        return mappedNormal(mesh, hit.triangle, hit.u, hit.v, side,
                            shadowcache::shadingNormal(mesh, hit.triangle, hit.u, hit.v, side));
    }
};

/// Where the ray through a place of the film starts, relative to the set's origin.
inline Vec3f rayStart(const CameraRays& rays, const Scene& scene, const FilmPosition& at) {
    return Vec3f(rays.start(at) - scene.mesh().origin);
}

/// What a camera sees at a place of the film.
inline View lookThrough(const CameraRays& rays, const Scene& scene, const FilmPosition& at) {
    const Vec3f direction(rays.direction(at));
    return {direction, scene.intersect(rayStart(rays, scene, at), direction)};
}

/// Where a hit of the scene lies in world space.
inline Vec3d worldPosition(const Scene& scene, const Hit& hit) {
    return scene.mesh().origin + Vec3d(hit.position);
}

}  // namespace shadowcache
