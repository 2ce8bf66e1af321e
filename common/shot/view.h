#pragma once

#include "common/shot/camera.h"
#include "common/trace/scene.h"

namespace shadowcache {

/// What a camera ray meets.
struct View {
    Vec3f direction;
    Hit hit;

    /// Unit normal of the place that was hit, on the viewer's side.
    Vec3f normal() const { return hit.normal.dot(direction) > 0 ? -hit.normal : hit.normal; }
};

/// What a camera sees at a place of the film.
///
/// @param x, y, aspect  as for rayDirection
inline View lookThrough(const Camera& camera, const Scene& scene, double x, double y,
                        double aspect) {
    const Vec3f origin(rayStart(camera, x, y, aspect) - scene.mesh().origin);
    const Vec3f direction(rayDirection(camera, x, y, aspect));
    return {direction, scene.intersect(origin, direction)};
}

/// Where a hit of the scene lies in world space.
inline Vec3d worldPosition(const Scene& scene, const Hit& hit) {
    return scene.mesh().origin + Vec3d(hit.position);
}

}  // namespace shadowcache
