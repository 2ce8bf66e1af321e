#pragma once

#include "common/emitters/emitter_part.h"
#include "common/trace/scene.h"

namespace shadowcache {

/// The shadow ray from a place to a point of an emitter.
struct EmitterRay {
    Vec3f way{0, 0, 0};  ///< to the point, or the direction of a sun
    float reach = 1;     ///< in lengths of `way`; infinite to a sun
};

/// @param from  where the ray starts, off the surface; relative to the mesh's origin
EmitterRay rayTo(const Scene& scene, const EmitterPart& part, const EmitterPoint& point,
                 const Vec3f& from) noexcept;

}  // namespace shadowcache
