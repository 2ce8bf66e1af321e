#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "common/cache/shadow_cache.h"
#include "common/mesh/mesh.h"
#include "render/app/job.h"

namespace shadowcache {

// A cache is stale where its fingerprint is not that of the set: the set has changed since.

/// The job's cache; null if it has none. With --stale-ok a stale one is opened with a warning.
///
/// @throws Error if it is stale, or cannot be read
std::unique_ptr<ShadowCache> openCacheOfSet(const RenderJob& job, const TriangleMesh& mesh);

/// The fingerprint of the job's cache, read from its header. @throws Error
std::optional<std::uint64_t> cacheFingerprint(const RenderJob& job);

}  // namespace shadowcache
