#pragma once

#include <cstdint>
#include <filesystem>

#include "bake/core/baker.h"

namespace shadowcache {

/// What a bake takes, predicted from a sample of its voxels.
struct BakeEstimate {
    double sampled = 0;  ///< share of the voxels that the sample has
    double spacing = 0;
    int level = 0;
    std::uint64_t items = 0;
    std::uint64_t rays = 0;         ///< what a bake takes is summed in bake/core/baker.cpp
    std::uint64_t emitters = 0;     ///< whose visibility is counted
    std::uint64_t emitterRays = 0;  ///< of the rays: to emitters
    double seconds = 0;             ///< of the whole run on this machine
    std::uint64_t bytes = 0;
    std::uint64_t memoryBytes = 0;  ///< most at once
};

/// Bakes a sample and writes it to the temporary folder for its size.
///
/// @param secondsBefore  time that the run takes to load the set and select voxels
/// @throws Error
BakeEstimate estimateBake(const Scene& scene, const BakeOptions& options,
                          const VoxelSelection& selection, double secondsBefore);

/// Prints an estimate, and writes it as JSON to `stats` if that is not empty. @throws Error
void report(const BakeEstimate& estimate, const std::filesystem::path& stats);

}  // namespace shadowcache
