#include "common/shadow_cache.h"

#include <openvdb/tree/ValueAccessor.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "common/cache_grids.h"
#include "common/error.h"
#include "common/paged_leaves.h"

namespace shadowcache {

namespace {

namespace fs = std::filesystem;

/// Values of an attribute, one a point, as a plain array.
template <class Value, class Array>
const Value* values(PointLeaf& leaf, const char* name, const fs::path& path) {
    attribute<Array>(leaf, name, 1, path);
    auto& array = Array::cast(leaf.attributeArray(name));
    array.expand();
    static_assert(sizeof(Value) == sizeof(typename Array::ValueType));
    return reinterpret_cast<const Value*>(array.constData());
}

CountRows countRows(const PointLeaf& leaf, const char* name, std::uint32_t stride,
                    const fs::path& path) {
    const auto& array = attribute<ByteArray>(leaf, name, stride, path);
    if (array.isUniform()) return constantRows(static_cast<std::uint8_t>(array.get(0)));
    return {reinterpret_cast<const std::uint8_t*>(array.constData()), stride};
}

std::uint32_t pointCount(const PointLeaf& leaf, const fs::path& path) {
    const auto& attributes = leaf.attributeSet();
    const openvdb::Index count = attributes.get(0)->size();
    for (std::size_t a = 1; a < attributes.size(); ++a)
        if (attributes.get(a)->size() != count)
            throwFileError(path, "damaged: attributes of one leaf differ in their number");
    return count;
}

LeafView makeView(PointLeaf& items, PointLeaf* blocks, const DirectionTiers& tiers,
                  const fs::path& path) {
    LeafView view;
    static_assert(sizeof *view.voxelEnd == sizeof *items.buffer().data());
    view.voxelEnd = reinterpret_cast<const std::uint32_t*>(items.buffer().data());
    view.items = pointCount(items, path);
    view.n = countRows(items, "n", tiers.baseCells(), path);
    view.d = countRows(items, "d", tiers.baseCells(), path);
    view.normal = values<Vec3f, VectorArray>(items, "normal", path);
    view.position = values<Vec3f, VectorArray>(items, "P", path);
    view.firstBlock = values<std::int32_t, IntArray>(items, "first_block", path);
    view.blockCount = values<std::int16_t, ShortArray>(items, "block_count", path);
    if (blocks) {
        view.blocks = pointCount(*blocks, path);
        view.blockKeys = values<std::int16_t, ShortArray>(*blocks, "key", path);
        view.blockN = countRows(*blocks, "n", kBlockCells, path);
        view.blockD = countRows(*blocks, "d", kBlockCells, path);
    }
    requireSound(view, tiers, path);
    return view;
}

/// Of parallel layers of a voxel keeps the nearest to the place, by `distance` from each: another
/// one sees other things.
/// Returns how many are left, at the front of `items`.
int keepNearestLayers(std::span<ItemView> items, const float* distance) {
    std::array<bool, ShadowCache::kMaxItems> farther{};
    for (std::size_t i = 0; i < items.size(); ++i)
        for (std::size_t j = 0; j < items.size(); ++j)
            farther[i] |= distance[j] < distance[i] && areLayers(items[i].normal, items[j].normal);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < items.size(); ++i)
        if (!farther[i]) items[kept++] = items[i];
    return static_cast<int>(kept);
}

/// Drops items that add next to nothing, and makes the others' weights, whose sum was `sum`, sum to
/// 1. Returns how many are left, at the front.
int keepWeighty(std::span<ItemView> items, float sum) {
    constexpr float kLeastShare = 0.03f;
    float left = 0;
    std::size_t kept = 0;
    for (const ItemView& item : items) {
        if (item.weight < kLeastShare * sum) continue;
        left += item.weight;
        items[kept++] = item;
    }
    for (ItemView& item : items.first(kept)) item.weight /= left;
    return static_cast<int>(kept);
}

}  // namespace

struct ShadowCache::Impl {
    CacheHeader header;
    std::size_t items = 0, blocks = 0;
    std::optional<PagedLeaves> paged;  ///< with a budget; else:
    CacheGrids grids;
    std::vector<LeafView> leaves;

    void readAll(const fs::path& path);
};

void ShadowCache::Impl::readAll(const fs::path& path) {
    grids = readGrids(path);
    header = grids.header;
    for (auto leaf = grids.items->tree().beginLeaf(); leaf; ++leaf) {
        leaf->setTransientData(static_cast<openvdb::Index32>(leaves.size()));
        leaves.push_back(
            makeView(*leaf, grids.blocks->tree().probeLeaf(leaf->origin()), header.tiers(), path));
        items += leaves.back().items;
        blocks += leaves.back().blocks;
    }
}

ShadowCache::ShadowCache(const fs::path& path, std::uint64_t memoryBudget)
    : impl_(std::make_unique<Impl>()) {
    if (memoryBudget == 0) {
        impl_->readAll(path);
        return;
    }
    impl_->header = readHeader(path);
    impl_->paged.emplace(path, impl_->header.tiers(), memoryBudget);
    impl_->items = impl_->paged->items();
    impl_->blocks = impl_->paged->blocks();
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

    const ShadowCache::Impl& cache;
    std::optional<PagedLeaves::Reader> paged;          ///< with a budget
    std::optional<PointGrid::ConstAccessor> accessor;  ///< without
};

ShadowCache::Reader::Reader(const ShadowCache& cache)
    : impl_(std::make_unique<Impl>(*cache.impl_)) {}
ShadowCache::Reader::~Reader() = default;
ShadowCache::Reader::Reader(Reader&&) noexcept = default;

int ShadowCache::Reader::gather(const Vec3d& position, const Vec3f& normal,
                                std::span<ItemView> out) {
    // Normals up to 60 degrees apart share items, the closer the more.
    constexpr float kMinAgreement = 0.5f;
    // Inverse of the distance from the plane of an item, in spacings, at which it counts a third.
    constexpr float kPlaneFalloff = 5;
    if (impl_->paged) impl_->paged->beginLookup();
    const Vec3d p = position / impl_->cache.header.spacing;
    const Vec3d low(std::floor(p.x), std::floor(p.y), std::floor(p.z));
    const Vec3d f = p - low;
    const openvdb::Coord corner(static_cast<int>(low.x), static_cast<int>(low.y),
                                static_cast<int>(low.z));
    int found = 0;
    for (int k = 0; k < 8; ++k) {
        const openvdb::Coord voxel = corner.offsetBy(k & 1, (k >> 1) & 1, k >> 2);
        const double trilinear =
            (k & 1 ? f.x : 1 - f.x) * (k & 2 ? f.y : 1 - f.y) * (k & 4 ? f.z : 1 - f.z);
        const LeafView* leaf = impl_->leafAt(voxel);
        if (!leaf) continue;
        const openvdb::Index offset = PointLeaf::coordToOffset(voxel);
        const std::uint32_t begin = offset ? leaf->voxelEnd[offset - 1] : 0u;
        const std::uint32_t end = leaf->voxelEnd[offset];
        if (begin == end) continue;
        const LeafView& view = *leaf;
        const int before = found;
        std::array<float, kMaxItems> distance;  // from the item's own plane
        for (std::uint32_t i = begin; i < end && found < kMaxItems; ++i) {
            const float agreement = view.normal[i].dot(normal) - kMinAgreement;
            if (agreement <= 0) continue;
            const auto firstBlock = static_cast<std::uint32_t>(view.firstBlock[i]);
            const Vec3f toItem =
                Vec3f(low - p) + Vec3f(Vec3d(k & 1, (k >> 1) & 1, k >> 2)) + view.position[i];
            // Another layer of surface a little above or below sees other things.
            const float plane = kPlaneFalloff * toItem.dot(normal);
            const float nearness = 1 / (1 + plane * plane * (1 + plane * plane));
            // The small addend keeps a lone item in a far corner from losing its weight altogether.
            const float weight = (static_cast<float>(trilinear) + 1e-6f) * agreement * nearness;
            distance[static_cast<std::size_t>(found - before)] =
                std::abs(toItem.dot(view.normal[i]));
            out[static_cast<std::size_t>(found++)] = {
                view.n.row(i),
                view.d.row(i),
                view.blockKeys + firstBlock,
                view.blockN.row(firstBlock),
                view.blockD.row(firstBlock),
                view.blockN.step,
                view.blockD.step,
                static_cast<std::uint32_t>(view.blockCount[i]),
                view.normal[i],
                weight};
        }
        if (found - before > 1)
            found =
                before + keepNearestLayers(out.subspan(static_cast<std::size_t>(before),
                                                       static_cast<std::size_t>(found - before)),
                                           distance.data());
    }
    float sum = 0;
    for (int i = 0; i < found; ++i) sum += out[static_cast<std::size_t>(i)].weight;
    return keepWeighty(out.first(static_cast<std::size_t>(found)), sum);
}

}  // namespace shadowcache
