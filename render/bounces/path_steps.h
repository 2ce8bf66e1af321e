#pragma once

#include <span>

#include "render/bounces/bounce_task.h"
#include "render/bounces/path_level.h"

namespace shadowcache {

/// The first level: what camera rays met.
PathVertices firstVertices(std::span<const BounceReceiver> receivers, const Rgb& luminanceWeights);

/// Directions for its diffuse rays: those of a pixel have numbers of one sequence.
DirectionNumbers firstNumbers(std::span<const BounceReceiver> receivers);

/// What the rays of a level met.
struct PathStep {
    PathVertices next;
    std::vector<VertexChildren> children;  ///< of the level's vertices
    std::uint64_t rays = 0;                ///< that were traced
};

/// Sends the rays that the vertices of a level have chosen to send, and makes the next level of
/// what they meet. A ray that meets the sky, or the back of a surface that is not double-sided, has
/// no vertex: the sky's light is known otherwise, and such backs reflect nothing.
///
/// @param plain  of what has no material
PathStep nextVertices(const EstimatorContext& context, const PlainLook& plain,
                      const PathLevel& level, const DirectionNumbers& numbers);

}  // namespace shadowcache
