#pragma once

#include <span>
#include <vector>

#include "common/cache/shadow_cache.h"
#include "common/predict/pooled_visibility.h"
#include "common/trace/scene.h"
#include "render/estimators/shading_point.h"

namespace shadowcache {

/// Looks up places in a cache and pools their counts. Reused from place to place; one object a
/// thread.
class PlaceLookup {
public:
    explicit PlaceLookup(const ShadowCache& cache)
        : reader_(cache), items_(ShadowCache::kMaxItems), pooled_(cache.header().tiers()) {}

    /// The items around a place; valid until the next call.
    std::span<const ItemView> find(const SetPlace& place);

    /// Pools the counts around a place, for it and all places within `radius`.
    ///
    /// @return number of items found
    int pool(const Scene& scene, const SetPlace& place, float radius);
    /// What was pooled last.
    const PooledVisibility& pooled() const { return pooled_; }

private:
    ShadowCache::Reader reader_;
    std::vector<ItemView> items_;
    PooledVisibility pooled_;
};

}  // namespace shadowcache
