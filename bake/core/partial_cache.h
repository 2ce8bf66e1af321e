#pragma once

#include <memory>
#include <mutex>

#include "bake/core/checkpoint.h"
#include "common/cache/shadow_cache.h"

namespace shadowcache {

/// What a bake has finished so far, as a cache for who renders meanwhile: pictures are unbiased
/// with any part of a cache. Thread-safe.
class PartialCache {
public:
    /// A bake in progress, until its end.
    class Source {
    public:
        /// @param cache       null: nobody wants it
        /// @param header      of the whole cache
        /// @param checkpoint  outlives the source
        Source(PartialCache* cache, CacheHeader header, Checkpoint& checkpoint);
        ~Source();
        Source(const Source&) = delete;
        Source& operator=(const Source&) = delete;

    private:
        PartialCache* cache_;
    };

    /// A cache of the items that are finished, from the checkpoint; null while there are none, and
    /// without a source.
    std::unique_ptr<ShadowCache> now();

private:
    std::mutex mutex_;
    CacheHeader header_;
    Checkpoint* checkpoint_ = nullptr;  ///< of the source
};

}  // namespace shadowcache
