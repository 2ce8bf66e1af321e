#pragma once

#include <vector>

#include "render/bounces/path_level.h"
#include "render/estimators/estimator.h"

namespace shadowcache {

/// Irradiance of a level's vertices by what the diffuse rays of their whole groups met.
///
/// Each member k of a group sends one ray and meets z_k. Member k estimates with all of them, by
/// the balance heuristic: pi sum_j L(z_j) g_kj V_kj / sum_m d_mj V_mj, where g_kj = cos_k cos_j /
/// r^2, d_mj is the density of m's rays at z_j, times pi, which is g_mj where they are drawn by the
/// cosine, and V_kj whether k sees z_j.
/// [Veach & Guibas 1995; Bekaert et al. 2002] What z_j mirrors is for the one it was met by, but
/// for the sky in a smooth surface: MirroredSky.
///
/// @param next     what the level's rays met; its light is known
/// @param rays     counts those that were traced
/// @param grouped  receives the same by light group, which it has room for; black, or empty
/// @return by vertex; 0 where a vertex is in no group
std::vector<Rgb> exchange(const EstimatorContext& context, const PathLevel& level,
                          const PathLevel& next, std::uint64_t& rays, GroupedLight& grouped);

}  // namespace shadowcache
