#pragma once

#include "common/base/pool.h"
#include "render/bounces/bounce_task.h"
#include "render/bounces/path_level.h"

namespace shadowcache {

/// A vertex as a place that direct light falls on.
ShadingPoint shadingPointOf(const EstimatorContext& context, const PathVertex& vertex);

/// Adds the direct light of the vertices that are to be lit to the level's light, estimated with
/// the samples of the plan: to the irradiance, and what lobes reflect of it to `mirrored`.
///
/// @return shadow rays
std::uint64_t lightVertices(const Estimator& estimator, const EstimatorPlan* plan,
                            Pool<Workspace>& workspaces, PathLevel& level);

}  // namespace shadowcache
