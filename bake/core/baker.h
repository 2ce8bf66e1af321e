#pragma once

#include "bake/core/bake_sample.h"
#include "bake/core/checkpoint.h"
#include "bake/core/options.h"
#include "bake/core/voxel_selection.h"
#include "common/cache/cache_items.h"
#include "common/trace/scene.h"

namespace shadowcache {

struct BakeResult {
    CacheHeader header;
    CacheItems items;
    std::uint64_t rays = 0;
    std::uint64_t emitterRays = 0;  ///< of these: to emitters
};

/// What the cache of a bake records of it.
CacheHeader headerOf(const TriangleMesh& mesh, const BakeOptions& options);

/// Bakes the visibility of a set: for every voxel its surface passes through and every side of it,
/// how many rays into each direction region reach the sky. A pure function of its arguments,
/// whatever the number of threads. Shows progress; Ctrl-C ends it with Error.
///
/// @param selection  bakes only its items, which have the same bits as in the whole bake. Its
/// voxels are those of a VoxelFrame over the set with the spacing of `options`
/// @param checkpoint  of this bake: regions that it has are not baked again, and those that are
/// finished are added to it; may be null
/// @throws Error on impossible options
BakeResult bake(const Scene& scene, const BakeOptions& options,
                const VoxelSelection& selection = {}, Checkpoint* checkpoint = nullptr);

/// Bakes runs of neighbouring voxels, drawn at random over the bake; all, where there are few.
///
/// @throws Error on impossible options
BakeSample sampleBake(const Scene& scene, const BakeOptions& options,
                      const VoxelSelection& selection);

}  // namespace shadowcache
