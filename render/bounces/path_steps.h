#pragma once

#include <span>

#include "render/bounces/bounce_task.h"
#include "render/bounces/path_vertex.h"

namespace shadowcache {

/// The first level: what camera rays met. The diffuse rays of a pixel have numbers of one sequence.
PathLevel firstLevel(std::span<const BounceReceiver> receivers, const Rgb& luminanceWeights);

/// Sends the rays that the vertices of a level decided to send, and makes the next level of what
/// they meet; children of the vertices are set. A ray that meets the sky, or the back of a surface
/// that is not double-sided, has no vertex: the sky's light is known otherwise, and such backs
/// reflect nothing.
///
/// @param plain  of what has no material
/// @param order  the vertices that send rays, near by near; may hold others
/// @param rays   counts those that were traced
PathLevel nextLevel(const EstimatorContext& context, const PlainLook& plain,
                    std::span<const std::uint32_t> order, PathLevel& level, std::uint64_t& rays);

}  // namespace shadowcache
