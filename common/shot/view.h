#pragma once

#include "common/base/tuned.h"
#include "common/mesh/normal_map.h"
#include "common/mesh/shading_normal.h"
#include "common/shot/camera_rays.h"
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

/// Where a camera's ray starts, relative to the set's origin.
inline Vec3f startIn(const Scene& scene, const CameraRay& ray) {
    return Vec3f(ray.start - scene.mesh().origin);
}

/// Least part of the rays of a pixel that show panes: light that these mirror is little, but from
/// few directions and so noisy.
inline SHADOWCACHE_TUNED(float, kLeastOfPanes, 0.25f);

/// What a camera's ray meets: nothing beyond its reach.
///
/// @param chance  as CameraPacket has it
inline View lookAlong(const CameraRay& ray, const Scene& scene, float chance) {
    const Vec3f direction(ray.direction);
    CameraPacket packet{};
    packet.set(0, startIn(scene, ray), direction, chance, ray.reach);
    View view{direction, {}};
    scene.look(packet, 1, 0, &view.hit);
    return view;
}

/// Where a hit of the scene lies in world space.
inline Vec3d worldPosition(const Scene& scene, const Hit& hit) {
    return scene.mesh().origin + Vec3d(hit.position);
}

}  // namespace shadowcache
