#pragma once

#include <string>

#include "bake/inspect/sky_view.h"
#include "bake/inspect/summary.h"

namespace shadowcache {

/// All that shadowcache-info tells of a cache.
struct CacheFacts {
    CacheHeader header;
    CacheItems items;
    CacheSummary summary;
    std::uint64_t fileBytes = 0;
};

/// @throws Error if the file is no cache
CacheFacts readFacts(const std::filesystem::path& path);

/// Labels of CacheSummary::rays and of CacheSummary::shares.
std::vector<std::string> rayLabels();
std::vector<std::string> shareLabels();

std::string factsAsText(const CacheFacts& facts);
std::string factsAsJson(const CacheFacts& facts);

std::string skyAsText(const SkyView& view);
std::string skyAsJson(const SkyView& view);

}  // namespace shadowcache
