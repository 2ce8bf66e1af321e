#pragma once

#include <string>

#include "bake/inspect/sky_view.h"
#include "bake/inspect/summary.h"
#include "common/cache/stored_bytes.h"

namespace shadowcache {

/// What shadowcache-info reports of a cache.
struct CacheFacts {
    CacheHeader header;           ///< of the file
    CacheItems items;             ///< all of them
    CacheSummary summary;         ///< of the items
    std::uint64_t fileBytes = 0;  ///< size of the file
    StoredBytes stored;           ///< parts of that
};

/// Reads a cache and sums it up.
///
/// @throws Error as readCache()
CacheFacts readFacts(const std::filesystem::path& path);

/// Labels of CacheSummary::rays, one a bin.
std::vector<std::string> rayLabels();
/// Labels of CacheSummary::shares, one a bin.
std::vector<std::string> shareLabels();

/// A cache's figures for people, several lines.
std::string factsAsText(const CacheFacts& facts);
/// A cache's figures for programs, one JSON object.
std::string factsAsJson(const CacheFacts& facts);

/// The sky above a place for people, several lines.
std::string skyAsText(const SkyView& view);
/// The sky above a place for programs, one JSON object.
std::string skyAsJson(const SkyView& view);

}  // namespace shadowcache
