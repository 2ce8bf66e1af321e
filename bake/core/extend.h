#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "bake/core/baker.h"

namespace shadowcache {

/// A cache that a bake adds to.
struct CacheToExtend {
    CacheHeader header;
    CacheItems items;
};

/// @param wanted  header of the bake that adds to it. Of a cache that counts no emitters, what it
/// counts is added to the items (recountEmitters)
/// @param labels  emitterLabels() of it, for messages
/// @throws Error if it cannot be read, or is of another set, spacing, seed, program version or
/// other options than the bake, naming the value found and the value wanted
CacheToExtend readCacheToExtend(const std::filesystem::path& path, const CacheHeader& wanted,
                                std::span<const std::string> labels = {});

/// Whether its items lack the counts of emitters that a bake has.
inline bool lacksEmitters(const CacheToExtend& cache, const CacheHeader& wanted) {
    return cache.header.emitters.empty() && !wanted.emitters.empty();
}

/// Adds the items of the cache to a bake that left them out, and has the same counts. The result is
/// the bake of both selections, and names the shots of both.
void addCache(const CacheToExtend& old, BakeResult& result);

}  // namespace shadowcache
