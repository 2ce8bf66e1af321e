#pragma once

#include <filesystem>

#include "bake/core/baker.h"

namespace shadowcache {

/// A cache that a bake adds to.
struct CacheToExtend {
    CacheHeader header;
    CacheItems items;
};

/// @param wanted  header of the bake that adds to it
/// @throws Error if it cannot be read, or is of another set, spacing, seed, program version or
/// other options than the bake, naming the value found and the value wanted
CacheToExtend readCacheToExtend(const std::filesystem::path& path, const CacheHeader& wanted);

/// Adds the items of the cache to a bake that left them out. The result is the bake of both
/// selections, and names the shots of both.
void addCache(const CacheToExtend& old, BakeResult& result);

}  // namespace shadowcache
