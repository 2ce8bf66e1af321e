#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/bounces/bounce_task.h"
#include "render/bounces/path_level.h"

namespace shadowcache {

/// A ray by a vertex's lobe, as the vertex's seed decides it.
struct LobeRay {
    Vec3f direction{0};
    Rgb share{0, 0, 0};  ///< reflected part of the radiance that it finds; 0: it finds none
};
LobeRay lobeRayOf(const PathVertex& vertex, const GlossyLobe& lobe);

/// Decides which of a frame's camera points, the vertices of the first level, send rays. All do in
/// a pixel that has the camera rays asked for; where it has k times as many, one of every k does.
std::vector<VertexChoice> chooseFirst(std::span<const BounceReceiver> receivers);

/// Decides which vertices send rays and which are lit, from their seeds, albedos, lobes and
/// predicted light alone.
///
/// Where a vertex has an item, whose irradiance is predicted, rays only correct that.
///
/// @param level             has its vertices, and their light as predicted
/// @param bouncesLeft       surfaces that light may still have met before these; kUnlimitedBounces
/// @param trust             BounceOptions::trust: the less, the more is left to Russian roulette
/// @param luminanceWeights  of the environment's colour space
std::vector<VertexChoice> choose(const PathLevel& level, int bouncesLeft, float trust,
                                 const Rgb& luminanceWeights);

}  // namespace shadowcache
