#pragma once

#include <cstdint>
#include <vector>

#include "bake/core/options.h"
#include "bake/core/patch.h"
#include "common/emitters/emitters.h"
#include "common/trace/scene.h"

namespace shadowcache {

/// What a bake counts the visibility of: none without BakeOptions::lamps.
///
/// @param mesh  outlives them
Emitters bakedEmitters(const TriangleMesh& mesh, const BakeOptions& options);

/// Counts the rays of a patch that reach the emitters it faces, whatever these emit: to points that
/// light it alike. More rays go to those that some of the first ones reach.
///
/// @param emitters  weighed by their shape
/// @param out       receives an EmitterCode of each
/// @return number of rays traced
std::uint64_t traceEmitters(const Scene& scene, const Emitters& emitters, const Patch& patch,
                            std::vector<std::uint16_t>& out);

}  // namespace shadowcache
