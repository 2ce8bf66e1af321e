#include "common/emitters/emitter_ray.h"

#include <limits>

namespace shadowcache {

EmitterRay rayTo(const Scene& scene, const EmitterPart& part, const EmitterPoint& point,
                 const Vec3f& from) noexcept {
    if (part.form == EmitterPart::Form::sun)
        return {point.direction, std::numeric_limits<float>::infinity()};
    if (part.form != EmitterPart::Form::triangle) return {point.position - from, 1};
    const Vec3f side = part.normal.dot(point.direction) < 0 ? part.normal : -part.normal;
    // Areas are often in the plane of a ceiling, which is not to hide them.
    if (!part.isSurface()) return {wayBetween(from, point.position, side), 1};
    return {wayBetween(from, scene.rayOrigin(point.position, part.placed, side), side), 1};
}

}  // namespace shadowcache
