#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/cache/item_table.h"
#include "common/cache/transport.h"
#include "common/light/environment.h"

namespace shadowcache {

/// How the surface of an item looks, in the mean.
struct ItemLook {
    Rgb albedo{0.5f, 0.5f, 0.5f};
    Rgb emission{0, 0, 0};  ///< [radiance]
};

/// The irradiance of all items of a cache under a sky, with the light that bounces: E^0 by the
/// visibility that the items counted, and E^b(i) = E^0(i) + 1 / K sum_k albedo_k E^(b-1)(k) over
/// the items k that the item's K rays met. No ray is traced. Biased as the counts are; the
/// residuals of a picture's paths correct it. Immutable, thread-safe. [Hasan et al. 2006;
/// docs/estimator.md]
class BounceSolve {
public:
    /// @param cache, items  items outlive the solve; of one cache, as `transport` is
    /// @param looks         by item
    /// @param bounces       to solve for; below 0: until they add next to nothing
    /// @param ofEmitters    by item: what the set's own emitters add to E^0, as its counts predict
    ///                      it; empty: what the item's rays met of them
    BounceSolve(const ShadowCache& cache, const ItemTable& items, const Transport& transport,
                const Environment& environment, std::span<const ItemLook> looks, int bounces,
                std::span<const Rgb> ofEmitters = {});

    /// The same of a part of the light, and of as many bounces.
    ///
    /// @param transport, looks  that this one was made with
    /// @param light    by item: where this one has `ofEmitters`, the part's, else the radiance that
    ///                 items emit of it
    BounceSolve ofPart(const Transport& transport, std::span<const ItemLook> looks,
                       std::span<const Rgb> light) const;

    const ItemTable& items() const { return items_; }

    /// Bytes of memory that it takes.
    std::size_t memoryBytes() const {
        return irradiance_.size() * irradiance_.front().capacity() * sizeof(Rgb);
    }

    /// Irradiance of an item with the light of up to `bounces` bounces; below 0: of all.
    /// [radiance sr]
    const Rgb& irradiance(std::uint32_t item, int bounces) const {
        return irradiance_[lastOf(bounces)][item];
    }
    /// What bounces add to it.
    Rgb indirect(std::uint32_t item, int bounces) const {
        return irradiance(item, bounces) - irradiance(item, 0);
    }
    /// The same at a place, by the items of a lookup there; 0 without items.
    Rgb indirect(std::span<const ItemView> items, int bounces) const;
    /// Exposed share of the surface of the items of a lookup: by it what their counts predict is
    /// too dark. At least that of less than one ray of an item; 1 without items.
    float exposure(std::span<const ItemView> items) const;

private:
    BounceSolve(const BounceSolve& whole, std::vector<Rgb> direct);
    /// Adds a bounce. @return what it changes, summed
    double addBounce(const Transport& transport, std::span<const ItemLook> looks);
    double sumOfLast() const;
    std::size_t lastOf(int bounces) const {
        const std::size_t last = irradiance_.size() - 1;
        return bounces < 0 || static_cast<std::size_t>(bounces) > last
                   ? last
                   : static_cast<std::size_t>(bounces);
    }

    const ItemTable& items_;
    const float leastExposure_;  ///< least exposure of an item none of whose rays is exposed
    const bool keepsAll_;        ///< else of bounces those of none and of all
    const bool countsEmitters_;  ///< whether it has `ofEmitters`
    int solved_ = 0;             ///< bounces
    std::vector<std::vector<Rgb>> irradiance_;  ///< [bounces][item]
};

}  // namespace shadowcache
