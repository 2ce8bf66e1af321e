#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "common/predict/cache_preview.h"

namespace shadowcache {

/// The irradiance that single items foretell. An item that many pixels see is summed up once, as
/// its irradiance near its own normal, or near one of a few others; a thread keeps the sums it met
/// last. The results do not depend on which those are.
class ItemIrradiance {
public:
    explicit ItemIrradiance(const CachePreview& preview) : preview_(preview) {}

    /// Mean of what `items`, whose weights sum to 1, foretell of a surface of unit normal `normal`.
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
