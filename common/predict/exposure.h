#pragma once

#include <algorithm>
#include <span>

#include "common/cache/item_table.h"
#include "common/cache/transport.h"

namespace shadowcache {

// Counts are of all of an item's surface, of which another surface may hide a part that nobody sees
// and that the sky does not light: what they predict is divided by the exposed share.

/// Least exposure of an item none of whose rays is exposed: that of less than one ray.
inline float leastExposureOf(const Transport& transport) {
    return 1 / static_cast<float>(transport.raysPerItem + 1);
}

/// By what the direct light of an item's counts is multiplied; what is less exposed than `least`
/// counts as hidden.
inline float exposedGain(float exposure, float least) {
    return exposure < least ? 1 : 1 / exposure;
}

/// Exposed share of the surface of the items of a lookup, at least `least`; 1 without items.
inline float exposureOf(std::span<const ItemView> items, const ItemTable& table, float least) {
    float sum = 0;
    for (const ItemView& item : items)
        sum +=
            item.weight * std::max(least, table.exposure(static_cast<std::uint32_t>(item.number)));
    return items.empty() ? 1 : sum;
}

}  // namespace shadowcache
