#include "bake/core/options.h"

#include <fmt/core.h>

#include <string>

#include "common/base/error.h"
#include "common/base/option_checks.h"
#include "common/cache/cache_items.h"

namespace shadowcache {

void validate(const BakeOptions& options) {
    requireRange("spacing", options.spacing, 0.0, kMostSpacing);
    requireRange("level", options.level, 0, kMaxCacheLevel);
    requireRange("rays", options.rays, 1, 255);
    if (options.shards < 1 || options.shard < 0 || options.shard >= options.shards)
        throw Error(fmt::format("--shard {}/{}: expected K/N with 1 <= K <= N", options.shard + 1,
                                options.shards));
}

}  // namespace shadowcache
