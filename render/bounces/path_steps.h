#pragma once

#include "render/bounces/bounce_task.h"
#include "render/bounces/path_vertex.h"

namespace shadowcache {

/// The first level: what camera rays met. Numbers of the diffuse rays are those of the camera rays
/// in their pixel's sequence; a ray is sent with the probability of the point's fraction.
PathLevel firstLevel(std::span<const BounceReceiver> receivers, const Rgb& luminanceWeights);

/// Sends the rays that the vertices of a level decided to send, and makes the next level of what
/// they meet; children of the vertices are set. A ray that meets the sky, or the back of a surface
/// that is not double-sided, has no vertex: the sky's light is known otherwise, and such backs
/// reflect nothing.
///
/// @param plain  of what has no material
/// @param rays   counts those that were traced
PathLevel nextLevel(const EstimatorContext& context, const PlainLook& plain, PathLevel& level,
                    std::uint64_t& rays);

}  // namespace shadowcache
