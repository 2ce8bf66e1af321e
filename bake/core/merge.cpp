#include "bake/core/merge.h"

#include <algorithm>
#include <sstream>

#include "bake/core/cache_match.h"
#include "bake/core/cache_part.h"
#include "common/base/progress.h"

namespace shadowcache {

namespace {

/// Seeds of both, each once.
std::string joinSeeds(const std::string& a, const std::string& b) {
    std::istringstream more(b);
    std::string joined = "," + a + ",", seed;
    while (std::getline(more, seed, ','))
        if (joined.find("," + seed + ",") == std::string::npos) joined += seed + ",";
    return joined.substr(1, joined.size() - 2);
}

}  // namespace

CacheItems mergeCaches(std::span<const std::filesystem::path> paths, CacheHeader& header) {
    CacheItems sum = readCache(paths[0], header);
    Progress progress("merge", paths.size());
    progress.add(1);
    for (const auto& path : paths.subspan(1)) {
        throwIfInterrupted();
        CacheHeader other;
        const CacheItems items = readCache(path, other);
        const auto require = [&](const char* what, const auto& found, const auto& wanted) {
            requireSame(path, what, found, wanted, "as in the first cache");
        };
        require("fingerprint of the set", other.fingerprint, header.fingerprint);
        require("spacing", other.spacing, header.spacing);
        require("direction level", other.level, header.level);
        require("adaptive refinement", other.adaptive, header.adaptive);
        header.seeds = joinSeeds(header.seeds, other.seeds);
        header.rays = std::max(header.rays, other.rays);
        sum = mergeItems(sum, items, header.tiers());
        if (header.part && other.part)
            header.part = joinParts(*header.part, *other.part, sum);
        else
            header.part.reset();
        progress.add(1);
    }
    return sum;
}

}  // namespace shadowcache
