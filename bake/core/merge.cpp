#include "bake/core/merge.h"

#include <algorithm>
#include <sstream>

#include "common/base/error.h"

namespace shadowcache {

namespace {

template <class T>
void requireSame(const std::filesystem::path& path, const char* what, const T& found,
                 const T& wanted) {
    if (found == wanted) return;
    std::ostringstream text;
    text.precision(15);
    text << what << ' ' << found << ", expected " << wanted << " as in the first cache";
    throwFileError(path, text.str());
}

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
    for (const auto& path : paths.subspan(1)) {
        CacheHeader other;
        const CacheItems items = readCache(path, other);
        requireSame(path, "fingerprint of the set", other.fingerprint, header.fingerprint);
        requireSame(path, "spacing", other.spacing, header.spacing);
        requireSame(path, "direction level", other.level, header.level);
        requireSame(path, "adaptive refinement", other.adaptive, header.adaptive);
        header.seeds = joinSeeds(header.seeds, other.seeds);
        header.rays = std::max(header.rays, other.rays);
        sum = mergeItems(sum, items, header.tiers());
    }
    return sum;
}

}  // namespace shadowcache
