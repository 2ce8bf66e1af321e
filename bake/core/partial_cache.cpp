#include "bake/core/partial_cache.h"

#include <string>
#include <utility>
#include <vector>

#include "bake/core/region_bytes.h"

namespace shadowcache {

PartialCache::Source::Source(PartialCache* cache, CacheHeader header, Checkpoint& checkpoint)
    : cache_(cache) {
    if (!cache_) return;
    const std::lock_guard lock(cache_->mutex_);
    cache_->header_ = std::move(header);
    cache_->checkpoint_ = &checkpoint;
}

PartialCache::Source::~Source() {
    if (!cache_) return;
    const std::lock_guard lock(cache_->mutex_);
    cache_->checkpoint_ = nullptr;
}

std::unique_ptr<ShadowCache> PartialCache::now() {
    std::vector<std::string> regions;
    CacheHeader header;
    {
        const std::lock_guard lock(mutex_);
        if (!checkpoint_) return nullptr;
        header = header_;
        regions = checkpoint_->finished(Checkpoint::Pass::items);
    }
    CacheItems items;
    for (std::string& region : regions)
        append(items, bakedFromBytes(std::exchange(region, {})).items);
    if (items.size() == 0) return nullptr;
    return makeCache(header, items);
}

}  // namespace shadowcache
