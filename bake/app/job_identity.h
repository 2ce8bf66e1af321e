#pragma once

#include "bake/app/job.h"
#include "bake/core/bake_identity.h"

namespace shadowcache {

/// All that the items of the job's cache depend on. Reads all files of the set and of the shot.
///
/// @throws Error if one cannot be read
BakeIdentity identityOf(const BakeJob& job);

/// The part of the items' identity that lookups depend on: not the shard, the rays or the level.
BakeIdentity identityOfLookups(const BakeJob& job, const BakeIdentity& ofItems);

}  // namespace shadowcache
