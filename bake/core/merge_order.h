#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/cache/cache_items.h"

namespace shadowcache {

/// The header of two caches together, and how items that both have are joined.
struct JoinedHeader {
    CacheHeader header;  ///< its part counts no sides yet
    Overlap overlap{};   ///< for mergeItems()
};

/// Joins what two caches of one set record of their bakes. Caches of the same seeds may hold
/// different shards, or different shots.
///
/// @param path   of `more`, for messages
/// @param owner  of `header`, for messages
/// @throws Error naming the file and what does not fit: another set, other options, rays that both
/// have counted
JoinedHeader joinHeaders(const CacheHeader& header, const std::string& owner,
                         const CacheHeader& more, const std::filesystem::path& path);

/// Numbers of the inputs of a merge: by seeds, in these by shot, in these the shards. Shards of a
/// shot become one first, then the shots of the same seeds, then the seeds, whatever order they
/// come in.
using MergeOrder = std::vector<std::vector<std::vector<std::size_t>>>;

/// Reads the headers of caches, and refuses those that cannot be merged before any item is read.
///
/// @param paths  at least one
/// @throws Error as joinHeaders()
MergeOrder orderMerge(std::span<const std::filesystem::path> paths);

/// Shards that are missing, in words: "seed 1: shards 4,6-8 of 8"; empty if there are none.
std::string missingText(const CacheHeader& header);

}  // namespace shadowcache
