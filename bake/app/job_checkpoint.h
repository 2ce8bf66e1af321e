#pragma once

#include <memory>

#include "bake/app/job.h"
#include "bake/core/baker.h"

namespace shadowcache {

/// The checkpoint that the job continues, or starts.
///
/// @param identity  of the job's items
/// @throws Error if that is of another bake
std::unique_ptr<Checkpoint> startCheckpoint(const BakeJob& job, const BakeIdentity& identity);

/// bake(), which leaves its checkpoint behind if it is interrupted. @throws Error
BakeResult bakeOrKeep(const Scene& scene, const BakeOptions& options,
                      const VoxelSelection& selection, Checkpoint& checkpoint);

}  // namespace shadowcache
