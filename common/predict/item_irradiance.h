#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "common/predict/cache_preview.h"

namespace shadowcache {

/// The irradiance that single items predict. It is summed up once for all places that an item
/// serves, at the item's own normal or at one of a few others, with its rotational gradient. The
/// sums that were used last are kept; results do not depend on which those are. One object a
/// thread.
class ItemIrradiance {
public:
    /// @param preview  outlives the object
    explicit ItemIrradiance(const CachePreview& preview) : preview_(preview) {}

    /// Irradiance on a surface of unit normal `normal`: the mean over `items`, whose weights sum
    /// to 1. 0 without items. [radiance sr]
    Rgb mean(std::span<const ItemView> items, const Vec3f& normal);

private:
    struct Entry {
        std::uint64_t key = std::numeric_limits<std::uint64_t>::max();
        IrradianceWithGradient irradiance;
    };

    const CachePreview& preview_;
    std::vector<Entry> entries_;  ///< by a hash of their keys

    const Rgb& flat(const ItemView& item, std::uint64_t key);
    const IrradianceWithGradient& near(const ItemView& item, std::uint64_t key,
                                       const Vec3f& normal);
    Entry& entry(std::uint64_t key);
};

}  // namespace shadowcache
