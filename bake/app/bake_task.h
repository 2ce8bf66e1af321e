#pragma once

#include <optional>

#include "bake/app/job.h"
#include "bake/core/extend.h"
#include "bake/core/surface_count.h"
#include "bake/core/voxel_frame.h"
#include "bake/core/voxel_selection.h"
#include "bake/shot/lookup_file.h"
#include "common/trace/scene.h"

namespace shadowcache {

/// Whether the spacing is left to us, and may follow the shot.
bool isSpacingFree(const BakeJob& job);

/// What a job bakes: with which spacing and level, and which voxels.
struct BakeTask {
    std::optional<SurfaceCount> count;  ///< of the set, if it was counted
    BakeOptions options;
    VoxelFrame frame;
    std::optional<CacheToExtend> old;
    VoxelSelection selection;

    /// @param shot   none: all of the set
    /// @param scene  of the job's set; has nothing that moves, before and after
    /// @param found  the shot's lookups if they are known; taken over
    /// @throws Error
    BakeTask(const BakeJob& job, const std::optional<ShotSource>& shot, Scene& scene,
             std::optional<ShotLookups>& found);

    /// The surface of all of the set.
    SurfaceCount countOfSet(const TriangleMesh& mesh) const;
};

}  // namespace shadowcache
