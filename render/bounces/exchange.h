#pragma once

#include <vector>

#include "common/trace/scene.h"
#include "render/bounces/vertex_groups.h"

namespace shadowcache {

/// Irradiance of vertices by what the diffuse rays of their whole groups met.
///
/// Each member k of a group sends one ray by the cosine and meets z_k. Member k estimates with all
/// of them, by the balance heuristic: pi sum_j L(z_j) g_kj V_kj / sum_m g_mj V_mj, where g_kj =
/// cos_k cos_j / r^2 is the density of k's rays at z_j, times pi, and V_kj whether k sees z_j.
/// [Veach & Guibas 1995; Bekaert et al. 2002] What z_j mirrors is for the one it was met by.
///
/// @param next  of the level's rays; its radiances are known
/// @param out   [vertex of level]: receives the members' irradiance
/// @return rays that were traced
std::uint64_t exchange(const Scene& scene, const VertexGroups& groups, const PathLevel& level,
                       const PathLevel& next, std::vector<Rgb>& out);

}  // namespace shadowcache
