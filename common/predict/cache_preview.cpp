#include "common/predict/cache_preview.h"

#include <algorithm>
#include <array>

#include "common/predict/count_tree.h"
#include "common/predict/lanes.h"

namespace shadowcache {

namespace {

/// Blocks of base cells: twenty cells of level 0, or eighty of level 1.
constexpr std::size_t kMostBaseBlocks = 5;

/// Visible shares of sixteen cells, in [0, 1], 0 without counts.
void visibleShares(const PooledBlock& counts, float* c) {
    for (int i = 0; i < kBlockCells; ++i) c[i] = counts.ratioOrNone(i);
}

void visibleShares(const BlockCounts& counts, float* c) {
    // Copies, so that the compiler knows that c does not alias the counts.
    std::array<std::uint8_t, kBlockCells> n, d;
    std::copy_n(counts.n, kBlockCells, n.begin());
    std::copy_n(counts.d, kBlockCells, d.begin());
    for (std::size_t i = 0; i < kBlockCells; ++i) {
        const auto rays = static_cast<float>(d[i]);
        const float share = static_cast<float>(n[i]) / (rays > 1 ? rays : 1.0f);
        c[i] = share < rays ? share : rays;
    }
    for (int i = 0; i < kBlockCells; ++i) c[i] = c[i] < 1 ? c[i] : 1.0f;
}

/// Prefetches an item's counts, most of which are in main memory: the waits overlap.
void prefetch(const ItemView& item, const DirectionTiers& tiers) {
    const auto fetch = [](const std::uint8_t* bytes, std::size_t count) {
        for (std::size_t i = 0; i < count; i += 64) __builtin_prefetch(bytes + i);
    };
    fetch(item.n, tiers.baseCells());
    fetch(item.d, tiers.baseCells());
    fetch(item.blockN, std::size_t{item.blockCount} * item.blockNStep);
    fetch(item.blockD, std::size_t{item.blockCount} * item.blockDStep);
}

/// Light through sixteen cells at a time, summed in sixteen lanes.
struct IrradianceSum {
    alignas(64) float lanes[3][kBlockCells] = {};

    void add(const CellMoments&, const CellLight& sky, const Vec3f&, const float* c) {
        for (int k = 0; k < 3; ++k)
            for (int i = 0; i < kBlockCells; ++i) lanes[k][i] += c[i] * sky.irradiance[k][i];
    }
    Rgb total() const { return {sumOf(lanes[0]), sumOf(lanes[1]), sumOf(lanes[2])}; }
};

/// The same with its gradient, to which a cell on the horizon adds the share of it that is above.
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
template <class Sum>
class Summation {
public:
    Summation(const Environment& environment, const CellSplitter& splitter, float leastShare,
              const Vec3f& normal)
        : environment_(environment),
          splitter_(splitter),
          leastShare_(leastShare),
          normal_(normal) {}

    template <CountTree Tree>
    const Sum& run(const Tree& tree) {
        lightBase(tree);
        walk(tree, 0.0f,
             [&](int tier, std::uint32_t block, const auto& counts, float parent,
                 const auto& descend) {
                 if (tier == 0) {
                     const Base& base = bases_[block];
                     if (base.visible) addBlock(tree, 0, block, base.sky, base.c, descend);
                     return;
                 }
                 alignas(64) float c[kBlockCells];
                 if (counts)
                     visibleShares(*counts, c);
                 else
                     std::fill_n(c, kBlockCells, parent);
                 if (!(maximumOf(c) > 0)) return;
                 CellLight sky;
                 light(tree, tier, block, sky);
                 addBlock(tree, tier, block, sky, c, descend);
             });
        return sum_;
    }

private:
    struct Base {
        CellLight sky;
        alignas(64) float c[kBlockCells];
        bool visible;
    };

    const Environment& environment_;
    const CellSplitter& splitter_;
    const float leastShare_;
    const Vec3f normal_;
    float leastNoise_ = 0;
    Sum sum_;
    std::array<Base, kMostBaseBlocks> bases_;

    template <CountTree Tree>
    const CellMoments& moments(const Tree& tree, int tier, std::uint32_t block) const {
        return environment_.cells(tree.tiers().levelOf(tier), block);
    }

    template <CountTree Tree>
    void light(const Tree& tree, int tier, std::uint32_t block, CellLight& sky) const {
        lightCells(moments(tree, tier, block), normal_, environment_.luminanceWeights(), sky);
    }

    /// Lights the base cells: what noise is too much depends on all of them.
    template <CountTree Tree>
    void lightBase(const Tree& tree) {
        float bright = 0;
        for (std::uint32_t b = 0; b < tree.tiers().baseBlocks(); ++b) {
            Base& base = bases_[b];
            visibleShares(tree.base(b), base.c);
            base.visible = maximumOf(base.c) > 0;
            if (!base.visible) continue;
            light(tree, 0, b, base.sky);
            alignas(64) float seen[kBlockCells];
            for (int i = 0; i < kBlockCells; ++i) seen[i] = base.c[i] * base.sky.light[i];
            bright += sumOf(seen);
        }
        leastNoise_ = std::max(splitter_.leastNoise(), leastShare_ * bright);
    }

    /// Adds the cells of a block that stay whole, and goes on with the children of the others;
    /// those without counts of their own are as visible as their parent.
    template <CountTree Tree, class Descend>
    void addBlock(const Tree& tree, int tier, std::uint32_t block, const CellLight& sky,
                  const float* c, const Descend& descend) {
        Splits split;
        splitter_.mark(tree, tier, block, sky, c, leastNoise_, split);
        alignas(64) float whole[kBlockCells];
        for (int i = 0; i < kBlockCells; ++i) whole[i] = split.any && split.marks[i] ? 0.0f : c[i];
        sum_.add(moments(tree, tier, block), sky, normal_, whole);
        split.forEach([&](int i) { descend(i, c[i]); });
    }
};

}  // namespace

Rgb IrradianceWithGradient::at(const Vec3f& tilt) const {
    Rgb irradiance;
    for (int k = 0; k < 3; ++k) irradiance[k] = std::max(0.0f, value[k] + tilt.dot(gradient[k]));
    return irradiance;
}

CachePreview::CachePreview(const Environment& environment, const DirectionTiers& tiers,
                           float leastShare)
    : environment_(environment),
      tiers_(tiers),
      splitter_(environment, tiers),
      leastShare_(leastShare) {}

Rgb CachePreview::irradiance(const PooledVisibility& pooled, const Vec3f& normal) const {
    return Summation<IrradianceSum>(environment_, splitter_, leastShare_, normal)
        .run(pooled)
        .total();
}

Rgb CachePreview::irradiance(const ItemView& item, const Vec3f& normal) const {
    prefetch(item, tiers_);
    const ItemCountTree counts(item, tiers_);
    return Summation<IrradianceSum>(environment_, splitter_, leastShare_, normal)
        .run(counts)
        .total();
}

IrradianceWithGradient CachePreview::irradianceWithGradient(const ItemView& item,
                                                            const Vec3f& normal) const {
    prefetch(item, tiers_);
    const ItemCountTree counts(item, tiers_);
    Summation<GradientSum> summation(environment_, splitter_, leastShare_, normal);
    const GradientSum& sum = summation.run(counts);
    IrradianceWithGradient irradiance{sum.total(), {}};
    for (std::size_t k = 0; k < 3; ++k)
        for (int axis = 0; axis < 3; ++axis)
            irradiance.gradient[k][axis] = sumOf(sum.byNormal[k][axis]);
    return irradiance;
}

}  // namespace shadowcache
