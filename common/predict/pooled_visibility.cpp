#include "common/predict/pooled_visibility.h"

#include <algorithm>
#include <cmath>

#include "common/math/direction_mesh.h"

namespace shadowcache {

namespace {

/// Adds one item's counts of sixteen cells. Cells without rays add nothing.
void addCounts16(PooledBlock& block, const std::uint8_t* n, const std::uint8_t* d, float weight) {
    for (int i = 0; i < kBlockCells; ++i) {
        const auto rays = static_cast<float>(d[i]);
        const float share = d[i] ? weight : 0.0f;
        block.visible[i] += share * static_cast<float>(n[i]) / std::max(rays, 1.0f);
        block.weight[i] += share;
        block.rays[i] += weight * rays;
        block.rays2[i] += weight * weight * rays;
    }
}

/// A cap of a cell in single precision, rounded up.
struct Cap {
    Vec3f axis;
    float angle;
};

std::vector<Cap> makeCaps(int level) {
    constexpr float kRounding = 1e-4f;
    std::vector<Cap> caps;
    for (std::uint32_t c = 0; c < cellCount(level); ++c) {
        const CellCap cap = cellCap(level, c);
        caps.push_back({Vec3f(cap.axis), static_cast<float>(cap.angle) + kRounding});
    }
    return caps;
}

/// Levels that have caps: the bases and their children.
constexpr int kCapLevels = 4;

const std::vector<Cap>& capsOf(int level) {
    static const std::array<std::vector<Cap>, kCapLevels> kCaps{makeCaps(0), makeCaps(1),
                                                                makeCaps(2), makeCaps(3)};
    return kCaps[static_cast<std::size_t>(level)];
}

bool touches(const Cap& cap, const Vec3f& axis, float angle) {
    const float sum = cap.angle + angle;
    return sum >= static_cast<float>(kPi) || axis.dot(cap.axis) >= std::cos(sum);
}

/// What was visible may be occluded now; what was occluded still is.
void makeUncertain(PooledBlock& block, int i) {
    /// Share of what was visible that stays so where something moves in front.
    static constexpr float kStillVisible = 0.75f;
    if (!(block.visible[i] > 0)) return;
    block.visible[i] *= kStillVisible;
    block.rays[i] = block.rays2[i] = 1;
}

}  // namespace

PooledVisibility::PooledVisibility(const DirectionTiers& tiers)
    : tiers_(tiers),
      base_((tiers.baseCells() + kBlockCells - 1) / kBlockCells),
      parents_(tiers.baseCells() * (1 + kBlockCells) + kBlockCells) {}

void PooledVisibility::pool(std::span<const ItemView> items) {
    for (const std::uint16_t key : used_) parents_[key] = {};
    used_.clear();
    links_.clear();
    blocks_.clear();
    occluderCones_.clear();
    items_ = items;
    std::fill(base_.begin(), base_.end(), PooledBlock{});
    for (const ItemView& item : items) addBase(item);
    if (tiers_.refinements() == 0) return;
    for (std::size_t i = 0; i < items.size(); ++i) linkBlocks(i);
}

void PooledVisibility::addBase(const ItemView& item) {
    const std::uint32_t cells = tiers_.baseCells();
    std::size_t b = 0;
    for (; (b + 1) * kBlockCells <= cells; ++b)
        addCounts16(base_[b], item.n + b * kBlockCells, item.d + b * kBlockCells, item.weight);
    if (b * kBlockCells < cells) {  // 20 cells of level 0
        std::array<std::uint8_t, kBlockCells> n{}, d{};
        std::copy(item.n + b * kBlockCells, item.n + cells, n.begin());
        std::copy(item.d + b * kBlockCells, item.d + cells, d.begin());
        addCounts16(base_[b], n.data(), d.data(), item.weight);
    }
}

/// Records where the counts of the item's blocks are, without reading them.
void PooledVisibility::linkBlocks(std::size_t item) {
    const ItemView& view = items_[item];
    for (std::size_t k = 0; k < view.blockCount; ++k) {
        const auto key = static_cast<std::uint16_t>(view.blockKeys[k]);
        Parent& parent = parents_[key];
        if (parent.link < 0) used_.push_back(key);
        links_.push_back(
            {static_cast<std::uint32_t>(item), static_cast<std::uint32_t>(k), parent.link});
        parent.link = static_cast<std::int32_t>(links_.size()) - 1;
    }
}

const PooledBlock* PooledVisibility::children(int tier, std::uint32_t cell) const {
    if (tier >= tiers_.refinements() || !hasChildren(tier, cell)) return nullptr;
    const std::uint16_t key = tiers_.blockKey(tier, cell);
    if (parents_[key].block < 0) {
        // The parents come first: the block's items without counts of it refer to them.
        const PooledBlock* parents =
            tier == 0 ? &base_[cell / kBlockCells] : children(0, cell / kBlockCells);
        parents_[key].block = static_cast<std::int32_t>(blocks_.size());
        const PooledBlock above = parents ? *parents : PooledBlock{};
        blocks_.push_back({});
        PooledBlock& block = blocks_.back();
        poolBlock(key, parents ? &above : nullptr, static_cast<int>(cell % kBlockCells), block);
        if (parents_[key].link < 0) used_.push_back(key);
        if (!occluderCones_.empty())
            applyOccluderCones(tiers_.baseLevel() + 2 * (tier + 1), cell * kBlockCells, block);
    }
    return &blocks_[static_cast<std::size_t>(parents_[key].block)];
}

/// Pools the block `key`. Items without it count in all its cells as they do in the parent, cell
/// `i` of `parents`; where no item has it, all its cells are like the parent.
void PooledVisibility::poolBlock(std::uint16_t key, const PooledBlock* parents, int i,
                                 PooledBlock& block) const {
    if (parents && parents_[key].link < 0) {
        std::fill_n(block.visible, kBlockCells, parents->visible[i]);
        std::fill_n(block.weight, kBlockCells, parents->weight[i]);
        std::fill_n(block.rays, kBlockCells, parents->rays[i]);
        std::fill_n(block.rays2, kBlockCells, parents->rays2[i]);
        return;
    }
    float counted = 0, countedVisible = 0;  // of the items that have it, in the parent cell
    for (std::int32_t l = parents_[key].link; l >= 0;
         l = links_[static_cast<std::size_t>(l)].next) {
        const Link& link = links_[static_cast<std::size_t>(l)];
        const ItemView& item = items_[link.item];
        const BlockCounts counts = item.block(link.block);
        addCounts16(block, counts.n, counts.d, item.weight);
        counted += item.weight;
        if (key < tiers_.baseCells() && item.d[key] > 0)
            countedVisible +=
                item.weight * static_cast<float>(item.n[key]) / static_cast<float>(item.d[key]);
    }
    float weight = 1 - counted, ratio = 0;
    if (weight <= 1e-4f || !parents) return;
    if (key < tiers_.baseCells()) {
        weight = std::max(0.0f, std::min(weight, parents->weight[i] - counted));
        if (weight <= 1e-4f) return;
        ratio = std::clamp((parents->visible[i] - countedVisible) / weight, 0.0f, 1.0f);
    } else {
        if (parents->weight[i] <= 0) return;
        ratio = parents->ratio(i);
    }
    for (int k = 0; k < kBlockCells; ++k) {
        if (block.weight[k] <= 0) continue;
        block.visible[k] += weight * ratio;
        block.weight[k] += weight;
    }
}

void PooledVisibility::addOccluderCone(const Vec3f& axis, float angle) {
    if (occluderCones_.empty()) uncertainBase_ = base_;
    occluderCones_.push_back({axis, angle});
    for (std::uint32_t b = 0; b < baseBlocks(); ++b) {
        uncertainBase_[b] = base_[b];
        applyOccluderCones(tiers_.baseLevel(), b * kBlockCells, uncertainBase_[b]);
    }
}

bool PooledVisibility::isInOccluderCone(int level, std::uint32_t cell) const {
    return std::any_of(occluderCones_.begin(), occluderCones_.end(), [&](const OccluderCone& cone) {
        return touches(capsOf(level)[cell], cone.axis, cone.angle);
    });
}

/// Makes those of sixteen cells uncertain that an occluder cone meets. Cells finer than the caps
/// are compared by their common ancestor.
void PooledVisibility::applyOccluderCones(int level, std::uint32_t firstCell,
                                          PooledBlock& block) const {
    for (std::uint32_t i = 0; i < kBlockCells && firstCell + i < cellCount(level); ++i) {
        const bool uncertain = level < kCapLevels
                                   ? isInOccluderCone(level, firstCell + i)
                                   : isInOccluderCone(level - 2, firstCell / kBlockCells);
        if (uncertain) makeUncertain(block, static_cast<int>(i));
    }
}

}  // namespace shadowcache
