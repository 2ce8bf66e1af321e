#pragma once

#include "bake/core/baker.h"
#include "common/shot/loaded_set.h"

namespace shadowcache {

/// Records in a cache's header how the files of its set were brought into the world.
void recordFiles(const MeshOptions& options, CacheHeader& header);

/// Bakes all of a set. What it returns makes a ShadowCache in memory, or a file by writeCache().
///
/// @throws Error on impossible options
BakeResult bakeSet(const LoadedSet& set, const BakeOptions& options);

}  // namespace shadowcache
