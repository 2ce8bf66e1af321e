#include "common/predict/cache_preview.h"

#include <algorithm>
#include <array>

#include "common/predict/lanes.h"

namespace shadowcache {

namespace {

/// A cell may be unsure of this much of the place's own light before it is split. In bright places
/// that is more than what samples need.
constexpr float kLeastShare = 8e-3f;

/// Blocks of base cells: twenty cells of level 0, or eighty of level 1.
constexpr std::size_t kMostBaseBlocks = 5;

/// Visible shares of sixteen cells at a time by the counts of several items, 0 without counts.
class PooledShares {
public:
    explicit PooledShares(const PooledVisibility& pooled) : pooled_(pooled) {}

    void base(std::uint32_t block, float* c) const { write(pooled_.base(block), c); }
    bool hasChildren(int tier, std::uint32_t cell) const { return pooled_.hasChildren(tier, cell); }
    /// @return false where nobody counted children of the cell
    bool children(int tier, std::uint32_t cell, float* c) const {
        const PooledBlock* block = pooled_.children(tier, cell);
        if (block) write(*block, c);
        return block != nullptr;
    }

private:
    const PooledVisibility& pooled_;

    static void write(const PooledBlock& block, float* c) {
        for (int i = 0; i < kBlockCells; ++i) c[i] = block.ratioOrNone(i);
    }
};

/// The same by the counts of one item.
class ItemShares {
public:
    ItemShares(const ItemView& item, const DirectionTiers& tiers) : item_(item), tiers_(tiers) {
        // Most of it is far from the processor still, and waits overlap.
        fetch(item.n, tiers.baseCells());
        fetch(item.d, tiers.baseCells());
        fetch(item.blockN, std::size_t{item.blockCount} * item.blockNStep);
        fetch(item.blockD, std::size_t{item.blockCount} * item.blockDStep);
    }

    void base(std::uint32_t block, float* c) const {
        const std::uint32_t first = block * kBlockCells;
        const std::uint32_t cells =
            std::min<std::uint32_t>(kBlockCells, tiers_.baseCells() - first);
        if (cells == kBlockCells) return write(item_.n + first, item_.d + first, c);
        std::array<std::uint8_t, kBlockCells> n{}, d{};  // 20 cells of level 0
        std::copy_n(item_.n + first, cells, n.begin());
        std::copy_n(item_.d + first, cells, d.begin());
        write(n.data(), d.data(), c);
    }
    bool hasChildren(int tier, std::uint32_t cell) const {
        return item_.findBlock(tiers_.blockKey(tier, cell)) >= 0;
    }
    bool children(int tier, std::uint32_t cell, float* c) const {
        if (tier >= tiers_.refinements()) return false;
        const int found = item_.findBlock(tiers_.blockKey(tier, cell));
        if (found < 0) return false;
        const BlockCounts counts = item_.block(static_cast<std::size_t>(found));
        write(counts.n, counts.d, c);
        return true;
    }

private:
    const ItemView& item_;
    const DirectionTiers& tiers_;

    static void fetch(const std::uint8_t* bytes, std::size_t count) {
        for (std::size_t i = 0; i < count; i += 64) __builtin_prefetch(bytes + i);
    }

    static void write(const std::uint8_t* n, const std::uint8_t* d, float* c) {
        // Copies, so that the compiler need not fear that c is where n or d are.
        std::array<std::uint8_t, kBlockCells> open, all;
        std::copy_n(n, kBlockCells, open.begin());
        std::copy_n(d, kBlockCells, all.begin());
        for (std::size_t i = 0; i < kBlockCells; ++i) {
            const auto rays = static_cast<float>(all[i]);
            const float share = static_cast<float>(open[i]) / (rays > 1 ? rays : 1.0f);
            c[i] = share < rays ? share : rays;
        }
        for (int i = 0; i < kBlockCells; ++i) c[i] = c[i] < 1 ? c[i] : 1.0f;
    }
};

/// Light through sixteen cells at a time, summed in sixteen lanes.
struct IrradianceSum {
    alignas(64) float lanes[3][kBlockCells] = {};

    void add(const CellMoments&, const CellLight& sky, const Vec3f&, const float* c) {
        for (int k = 0; k < 3; ++k)
            for (int i = 0; i < kBlockCells; ++i) lanes[k][i] += c[i] * sky.irradiance[k][i];
    }
    Rgb total() const { return {sumOf(lanes[0]), sumOf(lanes[1]), sumOf(lanes[2])}; }
};

/// The same with its gradient. Of a cell on the horizon as much of the light counts in it as is
/// above.
struct GradientSum : IrradianceSum {
    alignas(64) float byNormal[3][3][kBlockCells] = {};

    void add(const CellMoments& m, const CellLight& sky, const Vec3f& n, const float* c) {
        IrradianceSum::add(m, sky, n, c);
        alignas(64) float share[kBlockCells];
        for (int i = 0; i < kBlockCells; ++i) {
            const float height = n.x * m.axis[0][i] + n.y * m.axis[1][i] + n.z * m.axis[2][i];
            const float radius = m.sinRadius[i];
            share[i] = 0.5f + 0.5f * height / (radius > 1e-9f ? radius : 1e-9f);
        }
        for (int i = 0; i < kBlockCells; ++i) share[i] = share[i] > 0 ? share[i] : 0.0f;
        for (int i = 0; i < kBlockCells; ++i) share[i] = share[i] < 1 ? share[i] : 1.0f;
        for (int i = 0; i < kBlockCells; ++i) share[i] *= c[i];
        for (int k = 0; k < 3; ++k)
            for (int axis = 0; axis < 3; ++axis)
                for (int i = 0; i < kBlockCells; ++i)
                    byNormal[k][axis][i] += share[i] * m.firstMoment[k][axis][i];
    }
};

/// The sum over the tree of regions above a place: coarse where that is as good.
template <class Shares, class Sum>
class Summation {
public:
    Summation(const Environment& environment, const DirectionTiers& tiers,
              const CellSplitter& splitter, const Shares& shares, const Vec3f& normal)
        : environment_(environment),
          tiers_(tiers),
          splitter_(splitter),
          shares_(shares),
          normal_(normal) {}

    const Sum& run() {
        struct Base {
            CellLight sky;
            alignas(64) float c[kBlockCells];
            bool open;
        };
        std::array<Base, kMostBaseBlocks> bases;
        const std::uint32_t blocks = (tiers_.baseCells() + kBlockCells - 1) / kBlockCells;
        float bright = 0;
        for (std::uint32_t b = 0; b < blocks; ++b) {
            Base& base = bases[b];
            shares_.base(b, base.c);
            base.open = maximumOf(base.c) > 0;
            if (!base.open) continue;
            light(0, b, base.sky);
            alignas(64) float seen[kBlockCells];
            for (int i = 0; i < kBlockCells; ++i) seen[i] = base.c[i] * base.sky.light[i];
            bright += sumOf(seen);
        }
        leastNoise_ = std::max(splitter_.leastNoise(), kLeastShare * bright);
        for (std::uint32_t b = 0; b < blocks; ++b)
            if (bases[b].open) addSplit(0, b, bases[b].sky, bases[b].c);
        return sum_;
    }

private:
    const Environment& environment_;
    const DirectionTiers& tiers_;
    const CellSplitter& splitter_;
    const Shares& shares_;
    const Vec3f normal_;
    float leastNoise_ = 0;
    Sum sum_;

    const CellMoments& moments(int tier, std::uint32_t block) const {
        return environment_.cells(tiers_.baseLevel() + 2 * tier, block);
    }

    void light(int tier, std::uint32_t block, CellLight& sky) const {
        lightCells(moments(tier, block), normal_, environment_.luminanceWeights(), sky);
    }

    /// Adds the cells of a block that stay whole, and the children of the others.
    void addSplit(int tier, std::uint32_t block, const CellLight& sky, const float* c) {
        Splits split;
        splitter_.mark(shares_, tier, block, sky, c, leastNoise_, split);
        alignas(64) float whole[kBlockCells];
        for (int i = 0; i < kBlockCells; ++i) whole[i] = split.any && split.marks[i] ? 0.0f : c[i];
        sum_.add(moments(tier, block), sky, normal_, whole);
        split.forEach([&](int i) {
            addChildren(tier, block * kBlockCells + static_cast<std::uint32_t>(i), c[i]);
        });
    }

    /// Adds the children of a cell; without counts of their own they are as open as it.
    void addChildren(int tier, std::uint32_t cell, float open) {
        alignas(64) float c[kBlockCells];
        if (!shares_.children(tier, cell, c)) std::fill_n(c, kBlockCells, open);
        if (!(maximumOf(c) > 0)) return;
        CellLight sky;
        light(tier + 1, cell, sky);
        addSplit(tier + 1, cell, sky, c);
    }
};

}  // namespace

Rgb IrradianceNear::at(const Vec3f& tilt) const {
    Rgb irradiance;
    for (int k = 0; k < 3; ++k) irradiance[k] = std::max(0.0f, value[k] + tilt.dot(gradient[k]));
    return irradiance;
}

CachePreview::CachePreview(const Environment& environment, const DirectionTiers& tiers)
    : environment_(environment), tiers_(tiers), splitter_(environment, tiers) {}

Rgb CachePreview::irradiance(const PooledVisibility& pooled, const Vec3f& normal) const {
    const PooledShares shares(pooled);
    return Summation<PooledShares, IrradianceSum>(environment_, tiers_, splitter_, shares, normal)
        .run()
        .total();
}

Rgb CachePreview::irradiance(const ItemView& item, const Vec3f& normal) const {
    const ItemShares shares(item, tiers_);
    return Summation<ItemShares, IrradianceSum>(environment_, tiers_, splitter_, shares, normal)
        .run()
        .total();
}

IrradianceNear CachePreview::irradianceNear(const ItemView& item, const Vec3f& normal) const {
    const ItemShares shares(item, tiers_);
    Summation<ItemShares, GradientSum> summation(environment_, tiers_, splitter_, shares, normal);
    const GradientSum& sum = summation.run();
    IrradianceNear irradiance{sum.total(), {}};
    for (std::size_t k = 0; k < 3; ++k)
        for (int axis = 0; axis < 3; ++axis)
            irradiance.gradient[k][axis] = sumOf(sum.byNormal[k][axis]);
    return irradiance;
}

}  // namespace shadowcache
