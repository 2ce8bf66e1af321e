#include "common/shadow_cache.h"

#include <openvdb/tree/ValueAccessor.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/cache_grids.h"
#include "common/error.h"

namespace shadowcache {

namespace {

namespace fs = std::filesystem;

/// Rows of one repeated count each, for leaves whose counts OpenVDB keeps as a single value.
const std::uint8_t* constantRow(std::uint8_t value) {
    static const auto rows = [] {
        std::array<std::array<std::uint8_t, cellCount(1)>, 256> table{};
        for (std::size_t v = 0; v < table.size(); ++v) table[v].fill(static_cast<std::uint8_t>(v));
        return table;
    }();
    return rows[value].data();
}

/// Counts of the points of a leaf: row i begins at data + i * step (step 0: all rows are alike).
struct CountRows {
    const std::uint8_t* data = nullptr;
    std::size_t step = 0;

    const std::uint8_t* row(std::size_t i) const { return data + i * step; }
};

CountRows countRows(const PointLeaf& leaf, const char* name, std::size_t stride,
                    const fs::path& path) {
    const auto& array = attribute<ByteArray>(leaf, name, static_cast<openvdb::Index>(stride), path);
    if (array.isUniform()) return {constantRow(static_cast<std::uint8_t>(array.get(0))), 0};
    return {reinterpret_cast<const std::uint8_t*>(array.constData()), stride};
}

/// A leaf's attributes as raw arrays.
struct LeafView {
    const PointLeaf* leaf;
    CountRows n, d;
    std::vector<Vec3f> normal;
    std::vector<Vec3f> position;            ///< from the voxel's middle, in spacings
    std::vector<std::uint32_t> firstBlock;  ///< within the leaf, points + 1
    std::vector<std::int16_t> blockKeys;
    CountRows blockN, blockD;
};

LeafView makeView(const PointLeaf& items, const PointLeaf* blocks, const DirectionTiers& tiers,
                  const fs::path& path) {
    LeafView view{&items, {}, {}, {}, {}, {}, {}, {}, {}};
    view.n = countRows(items, "n", tiers.baseCells(), path);
    view.d = countRows(items, "d", tiers.baseCells(), path);
    const auto& normal = attribute<VectorArray>(items, "normal", 1, path);
    const auto& position = attribute<VectorArray>(items, "P", 1, path);
    const auto& first = attribute<IntArray>(items, "first_block", 1, path);
    const auto& count = attribute<ShortArray>(items, "block_count", 1, path);
    std::size_t blockTotal = 0;
    if (blocks) {
        const auto& key = attribute<ShortArray>(*blocks, "key", 1, path);
        blockTotal = key.size();
        view.blockKeys.resize(blockTotal);
        for (openvdb::Index b = 0; b < key.size(); ++b) view.blockKeys[b] = key.get(b);
        view.blockN = countRows(*blocks, "n", kBlockCells, path);
        view.blockD = countRows(*blocks, "d", kBlockCells, path);
    }
    for (openvdb::Index i = 0; i < normal.size(); ++i) {
        const openvdb::Vec3f v = normal.get(i);
        view.normal.emplace_back(v.x(), v.y(), v.z());
        const openvdb::Vec3f q = position.get(i);
        view.position.emplace_back(q.x(), q.y(), q.z());
        view.firstBlock.push_back(static_cast<std::uint32_t>(first.get(i)));
        if (first.get(i) < 0 || count.get(i) < 0 ||
            static_cast<std::size_t>(first.get(i)) + static_cast<std::size_t>(count.get(i)) >
                blockTotal)
            throwFileError(path, "damaged: an item's blocks lie outside the file's");
    }
    view.firstBlock.push_back(static_cast<std::uint32_t>(blockTotal));
    return view;
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
    CacheGrids grids;
    std::vector<LeafView> leaves;
    std::size_t items = 0, blocks = 0;
};

ShadowCache::ShadowCache(const fs::path& path) : impl_(std::make_unique<Impl>()) {
    impl_->grids = readGrids(path);
    const DirectionTiers tiers = header().tiers();
    auto& tree = impl_->grids.items->tree();
    for (auto leaf = tree.beginLeaf(); leaf; ++leaf) {
        const PointLeaf* blocks = impl_->grids.blocks->tree().probeConstLeaf(leaf->origin());
        leaf->setTransientData(static_cast<openvdb::Index32>(impl_->leaves.size()));
        impl_->leaves.push_back(makeView(*leaf, blocks, tiers, path));
        impl_->items += impl_->leaves.back().normal.size();
        impl_->blocks += impl_->leaves.back().blockKeys.size();
    }
}

ShadowCache::~ShadowCache() = default;

const CacheHeader& ShadowCache::header() const {
    return impl_->grids.header;
}

std::size_t ShadowCache::itemCount() const {
    return impl_->items;
}

std::size_t ShadowCache::blockCount() const {
    return impl_->blocks;
}

std::size_t ShadowCache::memoryBytes() const {
    std::size_t bytes = impl_->grids.items->memUsage() + impl_->grids.blocks->memUsage();
    for (const LeafView& leaf : impl_->leaves)
        bytes += sizeof leaf + 2 * leaf.normal.size() * sizeof(Vec3f) +
                 leaf.firstBlock.size() * sizeof(std::uint32_t) +
                 leaf.blockKeys.size() * sizeof(std::int16_t);
    return bytes;
}

struct ShadowCache::Reader::Impl {
    explicit Impl(const ShadowCache::Impl& source)
        : cache(source), accessor(source.grids.items->getConstAccessor()) {}

    const ShadowCache::Impl& cache;
    PointGrid::ConstAccessor accessor;
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
    const Vec3d p = position / impl_->cache.grids.header.spacing;
    const Vec3d low(std::floor(p.x), std::floor(p.y), std::floor(p.z));
    const Vec3d f = p - low;
    const openvdb::Coord corner(static_cast<int>(low.x), static_cast<int>(low.y),
                                static_cast<int>(low.z));
    int found = 0;
    float sum = 0;
    for (int k = 0; k < 8; ++k) {
        const openvdb::Coord voxel = corner.offsetBy(k & 1, (k >> 1) & 1, k >> 2);
        const double trilinear =
            (k & 1 ? f.x : 1 - f.x) * (k & 2 ? f.y : 1 - f.y) * (k & 4 ? f.z : 1 - f.z);
        const PointLeaf* leaf = impl_->accessor.probeConstLeaf(voxel);
        if (!leaf) continue;
        const openvdb::Index offset = PointLeaf::coordToOffset(voxel);
        const std::uint32_t begin = offset ? std::uint32_t{leaf->getValue(offset - 1)} : 0u;
        const std::uint32_t end = leaf->getValue(offset);
        if (begin == end) continue;
        const LeafView& view = impl_->cache.leaves[leaf->transientData()];
        for (std::uint32_t i = begin; i < end && found < kMaxItems; ++i) {
            const float agreement = view.normal[i].dot(normal) - kMinAgreement;
            if (agreement <= 0) continue;
            const std::uint32_t firstBlock = view.firstBlock[i];
            const Vec3f toItem =
                Vec3f(low - p) + Vec3f(Vec3d(k & 1, (k >> 1) & 1, k >> 2)) + view.position[i];
            // Another layer of surface a little above or below sees other things.
            const float plane = kPlaneFalloff * toItem.dot(normal);
            const float nearness = 1 / (1 + plane * plane * (1 + plane * plane));
            // The small addend keeps a lone item in a far corner from losing its weight altogether.
            const float weight = (static_cast<float>(trilinear) + 1e-6f) * agreement * nearness;
            out[static_cast<std::size_t>(found++)] = {view.n.row(i),
                                                      view.d.row(i),
                                                      view.blockKeys.data() + firstBlock,
                                                      view.blockN.row(firstBlock),
                                                      view.blockD.row(firstBlock),
                                                      static_cast<std::uint32_t>(view.blockN.step),
                                                      static_cast<std::uint32_t>(view.blockD.step),
                                                      view.firstBlock[i + 1] - firstBlock,
                                                      view.normal[i],
                                                      weight};
            sum += weight;
        }
    }
    return keepWeighty(out.first(static_cast<std::size_t>(found)), sum);
}

}  // namespace shadowcache
