#include "bake/core/finished_items.h"

#include <utility>

#include "common/base/error.h"

namespace shadowcache {

void FinishedItems::set(std::size_t region, Baked baked) {
    const CacheItems& items = baked.items;
    sizes_[region] = {items.size(), items.n.size(), items.blocks.size(), items.hits.size(),
                      items.emitters.size()};
    if (!checkpoint_ || checkpoint_->mayKeep(bytesOf(items))) kept_[region] = std::move(baked);
}

Baked FinishedItems::joined() {
    Baked all;
    reserve(all.items);
    for (std::size_t i = 0; i < kept_.size(); ++i) {
        const Baked baked = take(i);
        append(all.items, baked.items);
        all.rays += baked.rays;
        all.emitterRays += baked.emitterRays;
    }
    return all;
}

Baked FinishedItems::take(std::size_t region) {
    if (std::optional<Baked> kept = std::exchange(kept_[region], std::nullopt))
        return std::move(*kept);
    const auto bytes = checkpoint_->read(Checkpoint::Pass::items, region);
    if (!bytes)
        throwFileError(checkpoint_->folder(),
                       "finished regions are gone, expected all of them: "
                       "another bake to the same output has ended");
    return bakedFromBytes(*bytes);
}

/// The sum at its final size: it would hold twice as much while it grows.
void FinishedItems::reserve(CacheItems& all) const {
    Size sum{};
    for (const Size& size : sizes_)
        sum = {sum.items + size.items, sum.counts + size.counts, sum.blocks + size.blocks,
               sum.hits + size.hits, sum.emitters + size.emitters};
    all.voxel.reserve(sum.items);
    all.patch.reserve(sum.items);
    all.normal.reserve(sum.items);
    all.position.reserve(sum.items);
    all.n.reserve(sum.counts);
    all.d.reserve(sum.counts);
    all.firstBlock.reserve(sum.items + 1);
    all.blocks.reserve(sum.blocks);
    all.hits.reserve(sum.hits);
    all.emitters.reserve(sum.emitters);
}

}  // namespace shadowcache
