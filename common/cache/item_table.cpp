#include "common/cache/item_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>

#include "common/base/error.h"
#include "common/base/hash.h"
#include "common/base/interrupt.h"
#include "common/base/parallel.h"
#include "common/cache/hit_code.h"
#include "common/cache/lookup_weight.h"
#include "common/cache/open_cache.h"

namespace shadowcache {

namespace {

/// Weight of subpatches that do not reach a place: they count where nothing else does.
constexpr float kLeastOfPart = 1e-6f;

/// Exposure of items that no ray got away from: they count where nothing else does.
constexpr float kLeastExposure = 1e-3f;

constexpr std::size_t kItemsPerChunk = 1024;

/// Voxels have coordinates below this, which leaves room for those around them.
constexpr double kMostVoxel = 2e9;

std::uint64_t hashOf(const Vec3i& voxel) {
    const auto word = [](int v) { return std::uint64_t{static_cast<std::uint32_t>(v)}; };
    return hashWords(word(voxel.x) << 32 | word(voxel.y), word(voxel.z));
}

/// Weight of an item by its place in the neighbourhood of a point.
///
/// @param fromMiddle  of the item's voxel to the point, in spacings
float nearnessOf(const ItemTable::Item& item, const Vec3f& fromMiddle) {
    const PatchCode code = PatchCode::of(item.patch);
    if (code.subpatch != 0) return std::max(partWeight(code, fromMiddle), kLeastOfPart);
    double trilinear = 1;
    for (int axis = 0; axis < 3; ++axis)
        trilinear *= std::max(0.0, 1 - std::abs(static_cast<double>(fromMiddle[axis])));
    return nearOf(trilinear);
}

/// Of the rays that met something known; some of them at least, since something was baked.
float exposureOf(const LeafView& leaf, std::uint32_t item) {
    const std::span codes(leaf.hits + std::size_t{item} * leaf.hitsPerItem, leaf.hitsPerItem);
    const auto known =
        std::ranges::count_if(codes, [](std::uint16_t code) { return code != HitCode::kUnknown; });
    const auto free = std::ranges::count_if(codes, HitCode::isFree);
    return std::max(kLeastExposure, static_cast<float>(free) /
                                        static_cast<float>(std::max<std::ptrdiff_t>(1, known)));
}

}  // namespace

ItemTable::ItemTable(const ShadowCache& cache) : spacing_(cache.header().spacing) {
    if (cache.itemCount() >= kNoItem)
        throw Error(
            fmt::format("a cache of {} items, expected less than {}", cache.itemCount(), kNoItem));
    items_.reserve(cache.itemCount());
    const bool hits = cache.header().hits > 0;
    OpenCache::visitLeaves(cache, hits, [&](const Vec3i& origin, const LeafView& leaf) {
        throwIfInterrupted();
        std::uint32_t i = 0;
        for (std::uint32_t v = 0; v < kLeafVoxels; ++v) {
            const Vec3i voxel = origin + voxelInLeaf(v);
            for (; i < leaf.voxelEnd[v]; ++i)
                items_.push_back({voxel, leaf.patch[i], false, leaf.position[i], leaf.normal[i],
                                  hits ? exposureOf(leaf, i) : 1});
        }
    });
    index();
    look(cache);
}

void ItemTable::look(const ShadowCache& cache) {
    parallelFor(items_.size(), kItemsPerChunk, [&](const Chunk& chunk) {
        throwIfInterrupted();
        ShadowCache::Reader reader(cache);
        std::array<ItemView, ShadowCache::kMaxItems> found;
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const auto number = static_cast<std::uint32_t>(i);
            const int count = reader.lookUp(position(number), normal(number), found);
            const auto views = std::span(found).first(static_cast<std::size_t>(count));
            items_[i].found = std::ranges::find(views, i, &ItemView::number) != views.end();
        }
    });
}

void ItemTable::index() {
    slots_.assign(std::bit_ceil(2 * items_.size() + 1), kNoItem);
    for (std::uint32_t i = 0; i < items_.size(); ++i)
        if (i == 0 || items_[i].voxel != items_[i - 1].voxel) slots_[slotOf(items_[i].voxel)] = i;
}

/// The slot of a voxel, or the empty one where it would be.
std::uint32_t ItemTable::slotOf(const Vec3i& voxel) const noexcept {
    const auto mask = static_cast<std::uint32_t>(slots_.size() - 1);
    auto slot = static_cast<std::uint32_t>(hashOf(voxel)) & mask;
    while (slots_[slot] != kNoItem && items_[slots_[slot]].voxel != voxel) slot = (slot + 1) & mask;
    return slot;
}

/// The item with the largest weight above 0, of the voxels from `low` to `high` around the one
/// that is below the place along each axis.
template <class Weigh>
std::uint32_t ItemTable::heaviest(const Vec3d& place, int low, int high,
                                  const Weigh& weigh) const noexcept {
    const Vec3d floor(std::floor(place.x), std::floor(place.y), std::floor(place.z));
    // Written so that NaN finds nothing, too.
    if (!(std::max({std::abs(floor.x), std::abs(floor.y), std::abs(floor.z)}) < kMostVoxel))
        return kNoItem;
    const Vec3i corner(floor);
    std::uint32_t best = kNoItem;
    float most = 0;
    Vec3i step;
    for (step.z = low; step.z <= high; ++step.z)
        for (step.y = low; step.y <= high; ++step.y)
            for (step.x = low; step.x <= high; ++step.x) {
                const Vec3i voxel = corner + step;
                const Vec3f fromMiddle(place - Vec3d(voxel));
                for (std::uint32_t i = slots_[slotOf(voxel)];
                     i < items_.size() && items_[i].voxel == voxel; ++i) {
                    const float weight = weigh(items_[i], fromMiddle) * items_[i].exposure;
                    if (weight > most || (weight > 0 && weight == most && i < best)) {
                        most = weight;
                        best = i;
                    }
                }
            }
    return best;
}

std::uint32_t ItemTable::itemAt(const Vec3d& position, const Vec3f& normal) const noexcept {
    return heaviest(position / spacing_, 0, 1, [&](const Item& item, const Vec3f& fromMiddle) {
        const float agreement = agreementOf(item.normal, normal);
        if (!(agreement > 0)) return 0.0f;
        return itemWeight(nearnessOf(item, fromMiddle), agreement, item.position - fromMiddle,
                          normal);
    });
}

std::uint32_t ItemTable::itemOfSide(const Vec3d& place, int side) const noexcept {
    const auto weigh = [&](const Item& item, const Vec3f& fromMiddle) {
        if (PatchCode::of(item.patch).side != side) return 0.0f;
        return itemWeight(nearnessOf(item, fromMiddle), 1, item.position - fromMiddle, item.normal);
    };
    const std::uint32_t found = heaviest(place, 0, 1, weigh);
    return found != kNoItem ? found : heaviest(place, -1, 2, weigh);
}

std::size_t ItemTable::memoryBytes() const {
    return items_.capacity() * sizeof(Item) + slots_.capacity() * sizeof slots_[0];
}

}  // namespace shadowcache
