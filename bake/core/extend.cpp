#include "bake/core/extend.h"

#include "bake/core/cache_match.h"
#include "bake/core/cache_part.h"
#include "bake/core/emitter_match.h"
#include "bake/core/merge_order.h"

namespace shadowcache {

CacheToExtend readCacheToExtend(const std::filesystem::path& path, const CacheHeader& wanted,
                                std::span<const std::string> labels) {
    CacheToExtend cache;
    cache.items = readCache(path, cache.header);
    const auto require = [&](const char* what, const auto& found, const auto& expected) {
        requireSame(path, what, found, expected, "as this bake has it");
    };
    const CacheHeader& found = cache.header;
    require("fingerprint of the set", fingerprintText(found.fingerprint),
            fingerprintText(wanted.fingerprint));
    require("spacing", found.spacing, wanted.spacing);
    require("direction level", found.level, wanted.level);
    require("adaptive refinement", found.adaptive, wanted.adaptive);
    require("hits of an item", found.hits, wanted.hits);
    if (!lacksEmitters(cache, wanted))
        requireSameEmitters(path, found.emitters, {wanted.emitters, "this bake", labels});
    require("rays", found.rays(), wanted.rays());
    require("seed", found.seeds(), wanted.seeds());
    require("program version", found.version, wanted.version);
    if (const std::string missing = missingText(found); !missing.empty())
        throwFileError(path, "without " + missing + ", expected all: merge the shards first");
    return cache;
}

void addCache(const CacheToExtend& old, BakeResult& result) {
    result.items = mergeItems(old.items, result.items, result.header.tiers(), Overlap::keep);
    if (!old.header.part) {
        result.header.part.reset();
        result.header.bakes = old.header.bakes;
    } else if (result.header.part) {
        result.header.part =
            countPart(joinParts(*old.header.part, *result.header.part), result.items);
    }
}

}  // namespace shadowcache
