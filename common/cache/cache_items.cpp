#include "common/cache/cache_items.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "common/cache/emitter_code.h"

namespace shadowcache {

void addCounts(std::uint8_t& n, std::uint8_t& d, unsigned moreN, unsigned moreD) {
    unsigned sumN = n + moreN, sumD = d + moreD;
    if (sumD > 255) {
        const bool none = sumN == 0, all = sumN == sumD;
        // Halving at 255 as often as needed, in one step.
        unsigned halvings = 0;
        while ((sumD >> halvings) > 255) ++halvings;
        const unsigned half = halvings ? 1u << (halvings - 1) : 0;
        sumN = (sumN + half) >> halvings;
        sumD = sumD >> halvings;
        if (none)
            sumN = 0;
        else if (all)
            sumN = sumD;
        else
            sumN = std::clamp(sumN, 1u, sumD - 1);
    }
    n = static_cast<std::uint8_t>(sumN);
    d = static_cast<std::uint8_t>(sumD);
}

int sideOf(const Vec3f& n) {
    int axis = 0;
    for (int k = 1; k < 3; ++k)
        if (std::abs(n[k]) > std::abs(n[axis])) axis = k;
    return 2 * axis + (n[axis] < 0 ? 1 : 0);
}

void append(CacheItems& items, const CacheItems& more) {
    const auto join = [](auto& to, const auto& from) {
        to.insert(to.end(), from.begin(), from.end());
    };
    const auto offset = static_cast<std::uint32_t>(items.blocks.size());
    join(items.voxel, more.voxel);
    join(items.patch, more.patch);
    join(items.normal, more.normal);
    join(items.position, more.position);
    join(items.n, more.n);
    join(items.d, more.d);
    for (std::size_t i = 1; i < more.firstBlock.size(); ++i)
        items.firstBlock.push_back(offset + more.firstBlock[i]);
    join(items.blocks, more.blocks);
    join(items.hits, more.hits);
    join(items.emitters, more.emitters);
}

namespace {

/// Order of voxels in the file: by 8^3 leaf, then within the leaf, as OpenVDB stores them.
auto voxelOrder(const Vec3i& v) {
    return std::tuple(v.x >> 3, v.y >> 3, v.z >> 3, v.x & 7, v.y & 7, v.z & 7);
}

/// Appends item i of `from` to `to` without its blocks.
void appendItem(CacheItems& to, const CacheItems& from, std::size_t i, std::size_t baseCells) {
    to.voxel.push_back(from.voxel[i]);
    to.patch.push_back(from.patch[i]);
    to.normal.push_back(from.normal[i]);
    to.position.push_back(from.position[i]);
    const auto row = [&](auto& out, const auto& in, std::size_t values) {
        const auto begin = in.begin() + static_cast<std::ptrdiff_t>(i * values);
        out.insert(out.end(), begin, begin + static_cast<std::ptrdiff_t>(values));
    };
    row(to.n, from.n, baseCells);
    row(to.d, from.d, baseCells);
    row(to.hits, from.hits, from.hits.size() / from.size());
    row(to.emitters, from.emitters, from.emitters.size() / from.size());
}

/// Appends the blocks of item i of `a` and item j of `b` in the order of their keys, equal keys
/// added.
void appendBlocks(CacheItems& to, const CacheItems& a, std::size_t i, const CacheItems& b,
                  std::size_t j) {
    std::uint32_t p = a.firstBlock[i], q = b.firstBlock[j];
    while (p < a.firstBlock[i + 1] || q < b.firstBlock[j + 1]) {
        const bool hasA = p < a.firstBlock[i + 1], hasB = q < b.firstBlock[j + 1];
        if (hasA && (!hasB || a.blocks[p].key < b.blocks[q].key)) {
            to.blocks.push_back(a.blocks[p++]);
        } else if (!hasA || b.blocks[q].key < a.blocks[p].key) {
            to.blocks.push_back(b.blocks[q++]);
        } else {
            CountBlock sum = a.blocks[p++];
            const CountBlock& more = b.blocks[q++];
            for (std::size_t k = 0; k < kBlockCells; ++k)
                addCounts(sum.n[k], sum.d[k], more.n[k], more.d[k]);
            to.blocks.push_back(sum);
        }
    }
}

/// Adds the rays to emitters of item j of `more` to those of the last item.
void addEmitters(CacheItems& to, const CacheItems& more, std::size_t j) {
    const std::size_t emitters = more.emitters.size() / more.size();
    for (std::size_t e = 0; e < emitters; ++e) {
        std::uint16_t& code = to.emitters[to.emitters.size() - emitters + e];
        const std::uint16_t other = more.emitters[j * emitters + e];
        auto n = static_cast<std::uint8_t>(EmitterCode::visible(code));
        auto d = static_cast<std::uint8_t>(EmitterCode::rays(code));
        addCounts(n, d, static_cast<unsigned>(EmitterCode::visible(other)),
                  static_cast<unsigned>(EmitterCode::rays(other)));
        code = EmitterCode::of(n, d);
    }
}

void copyBlocks(CacheItems& to, const CacheItems& from, std::size_t i) {
    to.blocks.insert(to.blocks.end(), from.blocks.begin() + from.firstBlock[i],
                     from.blocks.begin() + from.firstBlock[i + 1]);
}

}  // namespace

bool itemBefore(const CacheItems& a, std::size_t i, const CacheItems& b, std::size_t j) {
    return std::tuple(voxelOrder(a.voxel[i]), a.patch[i]) <
           std::tuple(voxelOrder(b.voxel[j]), b.patch[j]);
}

CacheItems mergeItems(const CacheItems& a, const CacheItems& b, const DirectionTiers& tiers,
                      Overlap overlap) {
    const std::size_t baseCells = tiers.baseCells();
    CacheItems sum;
    std::size_t i = 0, j = 0;
    while (i < a.size() || j < b.size()) {
        if (j == b.size() || (i < a.size() && itemBefore(a, i, b, j))) {
            appendItem(sum, a, i, baseCells);
            copyBlocks(sum, a, i++);
        } else if (i == a.size() || itemBefore(b, j, a, i)) {
            appendItem(sum, b, j, baseCells);
            copyBlocks(sum, b, j++);
        } else if (overlap == Overlap::keep) {
            appendItem(sum, a, i, baseCells);
            copyBlocks(sum, a, i++);
            ++j;
        } else {
            appendItem(sum, a, i, baseCells);
            const std::size_t base = sum.n.size() - baseCells;
            for (std::size_t k = 0; k < baseCells; ++k)
                addCounts(sum.n[base + k], sum.d[base + k], b.n[j * baseCells + k],
                          b.d[j * baseCells + k]);
            addEmitters(sum, b, j);
            appendBlocks(sum, a, i++, b, j++);
        }
        sum.firstBlock.push_back(static_cast<std::uint32_t>(sum.blocks.size()));
    }
    return sum;
}

}  // namespace shadowcache
