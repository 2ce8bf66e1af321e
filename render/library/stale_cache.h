#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "common/cache/shadow_cache.h"
#include "common/mesh/mesh.h"
#include "render/library/shot.h"

namespace shadowcache {

/// A cache that is used with a set. It is stale where its fingerprint is not that of the set: the
/// set has changed since.
struct CacheOfSet {
    std::unique_ptr<ShadowCache> cache;
    bool stale = false;
};

/// Opens a set's cache.
///
/// @param memory   bytes for it; 0: all of it is read
/// @param staleOk  whether it may be stale
/// @throws Error if it is stale all the same, or cannot be read
CacheOfSet openCacheOfSet(const std::filesystem::path& path, std::uint64_t memory, bool staleOk,
                          const TriangleMesh& mesh);

/// Refuses pictures that show how light bounces as predicted, of a cache that cannot predict it.
///
/// @param cache  its file
/// @throws Error naming the file
void requireTransport(const Shot& shot, const RenderOptions& options,
                      const std::filesystem::path& cache);

}  // namespace shadowcache
