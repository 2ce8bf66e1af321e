#pragma once

#include "common/base/pool.h"
#include "render/bounces/bounce_task.h"
#include "render/bounces/vertex_groups.h"

namespace shadowcache {

/// Estimates the direct light of the vertices that are to be lit, with one sample each: adds it to
/// their irradiance, and what their lobes reflect of it to `mirrored`.
///
/// @return shadow rays
std::uint64_t lightVertices(const Estimator& estimator, const EstimatorPlan* plan,
                            const VertexGroups& groups, Pool<Workspace>& workspaces,
                            PathLevel& level);

}  // namespace shadowcache
