#include "common/cache/open_cache.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>

#include "common/base/error.h"
#include "common/cache/cache_grids.h"
#include "common/cache/cache_items.h"
#include "common/cache/grid_leaves.h"
#include "common/cache/lookup_weight.h"
#include "common/cache/paged_leaves.h"

namespace shadowcache {

namespace fs = std::filesystem;

/// What an open cache holds.
struct ShadowCache::Impl {
    CacheHeader header;
    std::size_t items = 0, blocks = 0;
    std::optional<PagedLeaves> paged;  ///< with a budget; else:
    CacheGrids grids;
    std::vector<LeafView> leaves;

    /// Takes all over that is in memory.
    ///
    /// @param path  for messages
    void take(CacheGrids all, const fs::path& path);
};

namespace {

/// What a lookup knows of an item beside its view.
struct Found {
    PatchCode code;
    float distance;  ///< of the place from the item's own plane, in spacings
};

/// Items of a lookup, in two arrays of one order.
struct FoundItems {
    std::span<ItemView> view;
    std::array<Found, ShadowCache::kMaxItems> about;
    std::size_t count = 0;

    bool full() const { return count == view.size() || count == about.size(); }
    void add(const ItemView& item, const Found& found) {
        view[count] = item;
        about[count++] = found;
    }
};

/// Of parallel layers of a voxel, items `begin` and on, keeps the nearest to the place: another one
/// sees other things.
void keepNearestLayers(FoundItems& items, std::size_t begin) {
    const auto sameLayer = [&](std::size_t i, std::size_t j) {
        const PatchCode &a = items.about[i].code, &b = items.about[j].code;
        return a.side == b.side && a.layer == b.layer;
    };
    std::size_t alike = begin;
    while (alike < items.count && sameLayer(alike, begin)) ++alike;
    if (alike == items.count) return;
    std::array<float, ShadowCache::kMaxItems> layerDistance;  // of the layer's nearest item
    for (std::size_t i = begin; i < items.count; ++i) {
        layerDistance[i] = items.about[i].distance;
        for (std::size_t j = begin; j < items.count; ++j)
            if (sameLayer(i, j))
                layerDistance[i] = std::min(layerDistance[i], items.about[j].distance);
    }
    std::size_t kept = begin;
    std::array<bool, ShadowCache::kMaxItems> farther{};
    for (std::size_t i = begin; i < items.count; ++i)
        for (std::size_t j = begin; j < items.count; ++j)
            farther[i] |= layerDistance[j] < layerDistance[i] && !sameLayer(i, j) &&
                          areDepthLayers(items.view[i].normal, items.view[j].normal);
    for (std::size_t i = begin; i < items.count; ++i) {
        if (farther[i]) continue;
        items.view[kept] = items.view[i];
        items.about[kept++] = items.about[i];
    }
    items.count = kept;
}

/// A depth layer that lies this much nearer to the place, in spacings, is another one.
constexpr float kSameLayer = 0.05f;

/// Subpatches stand for the larger ones of their depth layer as far as they reach: at
/// the rim of what was cut their weights fall to zero, and the larger ones' rise.
void preferParts(FoundItems& items) {
    std::array<int, ShadowCache::kMaxItems> cutsAt;
    int most = 0;
    for (std::size_t i = 0; i < items.count; ++i) {
        cutsAt[i] = subdivisionsOf(items.about[i].code.subpatch);
        most = std::max(most, cutsAt[i]);
    }
    std::array<float, ShadowCache::kMaxItems> left;
    std::fill_n(left.begin(), items.count, 1.0f);
    for (int cuts = most; cuts > 0; --cuts)
        for (std::size_t i = 0; i < items.count; ++i) {
            if (cutsAt[i] >= cuts) continue;
            float reach = 0;
            for (std::size_t j = 0; j < items.count; ++j)
                if (cutsAt[j] == cuts &&
                    items.about[j].distance <= items.about[i].distance + kSameLayer)
                    reach += items.view[j].weight;
            left[i] *= 1 - std::min(reach, 1.0f);
        }
    for (std::size_t i = 0; i < items.count; ++i) items.view[i].weight *= left[i];
}

#ifndef SHADOWCACHE_TUNABLE
static_assert(kLeastItemShare * ShadowCache::kMaxItems < 1, "one item at least must be left");
#endif

/// Drops items that add next to nothing, and makes the others' weights sum to 1. Returns how many
/// are left, at the front.
int keepWeighty(std::span<ItemView> items) {
    float sum = 0, left = 0;
    for (const ItemView& item : items) sum += item.weight;
    std::size_t kept = 0;
    for (const ItemView& item : items) {
        if (item.weight < kLeastItemShare * sum) continue;
        left += item.weight;
        items[kept++] = item;
    }
    for (ItemView& item : items.first(kept)) item.weight /= left;
    return static_cast<int>(kept);
}

}  // namespace

void ShadowCache::Impl::take(CacheGrids all, const fs::path& path) {
    grids = std::move(all);
    header = grids.header;
    for (auto leaf = grids.items->tree().beginLeaf(); leaf; ++leaf) {
        leaf->setTransientData(static_cast<openvdb::Index32>(leaves.size()));
        leaves.push_back(
            viewOf(*leaf, grids.blocks->tree().probeLeaf(leaf->origin()), header, path));
        leaves.back().firstItem = items;
        items += leaves.back().items;
        blocks += leaves.back().blocks;
    }
}

void OpenCache::visitLeaves(const ShadowCache& cache, bool hits, const VisitLeaf& visit) {
    const ShadowCache::Impl& open = *cache.impl_;
    if (!open.paged) {
        std::size_t i = 0;
        for (auto leaf = open.grids.items->tree().cbeginLeaf(); leaf; ++leaf)
            visit(toVoxel(leaf->origin()), open.leaves[i++]);
        return;
    }
    PagedLeaves::Reader reader(*open.paged, hits);
    for (std::size_t i = 0; i < open.paged->size(); ++i) {
        const openvdb::Coord& origin = open.paged->origin(i);
        reader.beginLookup();
        visit(toVoxel(origin), *reader.find(origin));
    }
}

ShadowCache::ShadowCache(const fs::path& path, std::uint64_t memoryBudget)
    : impl_(std::make_unique<Impl>()) {
    if (memoryBudget == 0) {
        impl_->take(readGrids(path), path);
        return;
    }
    impl_->header = readHeader(path);
    impl_->paged.emplace(path, impl_->header, memoryBudget);
    impl_->items = impl_->paged->items();
    impl_->blocks = impl_->paged->blocks();
}

ShadowCache::ShadowCache(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

std::unique_ptr<ShadowCache> OpenCache::make(const CacheHeader& header, const CacheItems& items) {
    auto impl = std::make_unique<ShadowCache::Impl>();
    impl->take(makeGrids(header, items), "cache in memory");
    return std::unique_ptr<ShadowCache>(new ShadowCache(std::move(impl)));
}

std::unique_ptr<ShadowCache> makeCache(const CacheHeader& header, const CacheItems& items) {
    return OpenCache::make(header, items);
}

ShadowCache::~ShadowCache() = default;

const CacheHeader& ShadowCache::header() const {
    return impl_->header;
}

std::size_t ShadowCache::itemCount() const {
    return impl_->items;
}

std::size_t ShadowCache::blockCount() const {
    return impl_->blocks;
}

std::size_t ShadowCache::memoryBytes() const {
    if (impl_->paged) return impl_->paged->use().held;
    return impl_->grids.items->memUsage() + impl_->grids.blocks->memUsage() +
           impl_->leaves.size() * sizeof(LeafView);
}

MemoryUse ShadowCache::memoryUse() const {
    return impl_->paged ? impl_->paged->use() : MemoryUse();
}

struct ShadowCache::Reader::Impl {
    explicit Impl(const ShadowCache::Impl& source) : cache(source) {
        if (source.paged)
            paged.emplace(*source.paged);
        else
            accessor.emplace(source.grids.items->getConstAccessor());
    }

    const LeafView* leafAt(const openvdb::Coord& voxel) {
        if (paged) return paged->find(voxel);
        const PointLeaf* leaf = accessor->probeConstLeaf(voxel);
        return leaf ? &cache.leaves[leaf->transientData()] : nullptr;
    }

    /// The leaf that holds an item.
    const LeafView& leafOf(std::uint64_t number) {
        if (paged) return *paged->find(cache.paged->origin(cache.paged->leafWith(number)));
        if (number < last->firstItem || number >= last->firstItem + last->items)
            last = &*std::prev(
                std::ranges::upper_bound(cache.leaves, number, std::less(), &LeafView::firstItem));
        return *last;
    }

    void collect(const Vec3d& position, const Vec3f& normal, float leastOfPart, FoundItems& found);

    const ShadowCache::Impl& cache;
    std::optional<PagedLeaves::Reader> paged;          ///< with a budget
    std::optional<PointGrid::ConstAccessor> accessor;  ///< without
    const LeafView* last = cache.leaves.data();        ///< that leafOf() found, without
};

namespace {

ItemView viewOfItem(const LeafView& leaf, std::uint32_t i, float weight) {
    const auto first = static_cast<std::uint32_t>(leaf.firstBlock[i]);
    return {leaf.n.row(i),          leaf.d.row(i),
            leaf.blockKeys + first, leaf.blockN.row(first),
            leaf.blockD.row(first), leaf.blockN.step,
            leaf.blockD.step,       static_cast<std::uint32_t>(leaf.blockCount[i]),
            leaf.normal[i],         weight,
            leaf.firstItem + i};
}

}  // namespace

ShadowCache::Reader::Reader(const ShadowCache& cache)
    : impl_(std::make_unique<Impl>(*cache.impl_)) {}
ShadowCache::Reader::~Reader() = default;
ShadowCache::Reader::Reader(Reader&&) noexcept = default;

/// Appends the items around a place. Parts of patches that do not reach it weigh `leastOfPart`, or
/// are left out if that is 0.
void ShadowCache::Reader::Impl::collect(const Vec3d& position, const Vec3f& normal,
                                        float leastOfPart, FoundItems& found) {
    const Vec3d p = position / cache.header.spacing;
    const Vec3d low(std::floor(p.x), std::floor(p.y), std::floor(p.z));
    const Vec3d f = p - low;
    // No voxel has coordinates beyond 2^31. Written so that NaN finds nothing, too.
    if (!(std::max({std::abs(low.x), std::abs(low.y), std::abs(low.z)}) < 2e9)) return;
    const openvdb::Coord corner(static_cast<int>(low.x), static_cast<int>(low.y),
                                static_cast<int>(low.z));
    for (int k = 0; k < 8; ++k) {
        const Vec3i step(k & 1, (k >> 1) & 1, k >> 2);
        const openvdb::Coord voxel = corner.offsetBy(step.x, step.y, step.z);
        const double trilinear =
            (step.x ? f.x : 1 - f.x) * (step.y ? f.y : 1 - f.y) * (step.z ? f.z : 1 - f.z);
        const LeafView* leaf = leafAt(voxel);
        if (!leaf) continue;
        const openvdb::Index offset = PointLeaf::coordToOffset(voxel);
        const std::uint32_t begin = offset ? leaf->voxelEnd[offset - 1] : 0u;
        const std::uint32_t end = leaf->voxelEnd[offset];
        if (begin == end) continue;
        const LeafView& view = *leaf;
        const Vec3f fromMiddle(f - Vec3d(step));
        const std::size_t before = found.count;
        for (std::uint32_t i = begin; i < end && !found.full(); ++i) {
            const float agreement = agreementOf(view.normal[i], normal);
            if (agreement <= 0) continue;
            const PatchCode code = PatchCode::of(view.patch[i]);
            const float near = code.subpatch == 0
                                   ? nearOf(trilinear)
                                   : std::max(partWeight(code, fromMiddle), leastOfPart);
            if (near == 0) continue;
            const Vec3f toItem = view.position[i] - fromMiddle;
            const float weight = itemWeight(near, agreement, toItem, normal);
            found.add(viewOfItem(view, i, weight), {code, std::abs(toItem.dot(view.normal[i]))});
        }
        if (found.count - before > 1) keepNearestLayers(found, before);
    }
}

ItemView ShadowCache::Reader::item(std::uint64_t number) {
    if (impl_->paged) impl_->paged->beginLookup();
    const LeafView& leaf = impl_->leafOf(number);
    return viewOfItem(leaf, static_cast<std::uint32_t>(number - leaf.firstItem), 1);
}

int ShadowCache::Reader::lookUp(const Vec3d& position, const Vec3f& normal,
                                std::span<ItemView> out) {
    if (impl_->paged) impl_->paged->beginLookup();
    FoundItems found{out, {}};
    impl_->collect(position, normal, 0, found);
    // A place off the surface, as on something that moves, may lie beside all subpatches.
    if (found.count == 0) impl_->collect(position, normal, 1e-6f, found);
    preferParts(found);
    return keepWeighty(out.first(found.count));
}

}  // namespace shadowcache
