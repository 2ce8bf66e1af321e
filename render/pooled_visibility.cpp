#include "render/pooled_visibility.h"

#include <algorithm>
#include <cmath>

#include "common/direction_mesh.h"

namespace shadowcache {

namespace {

/// Adds one item's counts of sixteen cells. Cells without rays add nothing.
void addCounts16(PooledBlock& block, const std::uint8_t* n, const std::uint8_t* d, float weight) {
    for (int i = 0; i < kBlockCells; ++i) {
        const auto rays = static_cast<float>(d[i]);
        const float share = d[i] ? weight : 0.0f;
        block.open[i] += share * static_cast<float>(n[i]) / std::max(rays, 1.0f);
        block.weight[i] += share;
        block.rays[i] += weight * rays;
        block.rays2[i] += weight * weight * rays;
    }
}

/// Middle of a cell, and the angle around it that holds the cell.
struct CellCap {
    Vec3f axis;
    float angle;
};

std::vector<CellCap> makeCaps(int level) {
    std::vector<CellCap> caps;
    for (std::uint32_t c = 0; c < cellCount(level); ++c) {
        const SphericalTriangle t = cellTriangle(level, c);
        const Vec3d axis = cellCenter(level, c);
        const double least = std::min({axis.dot(t.a), axis.dot(t.b), axis.dot(t.c)});
        caps.push_back({Vec3f(axis), static_cast<float>(std::acos(std::min(1.0, least))) + 1e-4f});
    }
    return caps;
}

/// Caps of levels 0 to 3, the bases and their children.
const std::vector<CellCap>& capsOf(int level) {
    static const std::array<std::vector<CellCap>, 4> kCaps{makeCaps(0), makeCaps(1), makeCaps(2),
                                                           makeCaps(3)};
    return kCaps[static_cast<std::size_t>(level)];
}

bool touches(const CellCap& cap, const Vec3f& axis, float angle) {
    const float sum = cap.angle + angle;
    return sum >= static_cast<float>(kPi) || axis.dot(cap.axis) >= std::cos(sum);
}

/// What was open may be hidden now; what was hidden still is.
void doubtCell(PooledBlock& block, int i) {
    constexpr float kOpenStill = 0.75f;
    if (!(block.open[i] > 0)) return;
    block.open[i] *= kOpenStill;
    block.rays[i] = block.rays2[i] = 1;
}

}  // namespace

PooledVisibility::PooledVisibility(const DirectionTiers& tiers)
    : tiers_(tiers),
      base_((tiers.baseCells() + kBlockCells - 1) / kBlockCells),
      slots_(tiers.baseCells() * (1 + kBlockCells) + kBlockCells, -1) {}

void PooledVisibility::pool(std::span<const ItemView> items) {
    for (const std::uint16_t key : used_) slots_[key] = -1;
    used_.clear();
    blocks_.clear();
    counted_.clear();
    countedOpen_.clear();
    std::fill(base_.begin(), base_.end(), PooledBlock{});
    for (const ItemView& item : items) addBase(item);
    if (tiers_.refinements() == 0) return;
    for (const ItemView& item : items) addBlocks(item);
    completeBlocks();
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

void PooledVisibility::addBlocks(const ItemView& item) {
    for (std::size_t k = 0; k < item.blockCount; ++k) {
        const auto key = static_cast<std::uint16_t>(item.blockKeys[k]);
        std::int16_t& slot = slots_[key];
        if (slot < 0) {
            slot = static_cast<std::int16_t>(blocks_.size());
            blocks_.emplace_back();
            counted_.push_back(0);
            countedOpen_.push_back(0);
            used_.push_back(key);
        }
        const auto s = static_cast<std::size_t>(slot);
        addCounts16(blocks_[s], item.blockN + k * item.blockNStep,
                    item.blockD + k * item.blockDStep, item.weight);
        counted_[s] += item.weight;
        if (key < tiers_.baseCells() && item.d[key] > 0)
            countedOpen_[s] +=
                item.weight * static_cast<float>(item.n[key]) / static_cast<float>(item.d[key]);
    }
}

void PooledVisibility::completeBlocks() {
    // Items without a block say of all its cells what they say of their parent.
    for (std::size_t s = 0; s < used_.size(); ++s) {
        const float missing = 1 - counted_[s];
        if (missing <= 1e-4f) continue;
        const std::uint32_t key = used_[s];
        const bool first = key < tiers_.baseCells();
        float weight = missing, ratio = 0;
        if (first) {
            const PooledBlock& parents = base_[key / kBlockCells];
            const int i = static_cast<int>(key % kBlockCells);
            weight = std::max(0.0f, std::min(missing, parents.weight[i] - counted_[s]));
            if (weight <= 1e-4f) continue;
            ratio = std::clamp((parents.open[i] - countedOpen_[s]) / weight, 0.0f, 1.0f);
        } else {
            const std::uint32_t cell = key - tiers_.baseCells();
            const PooledBlock* parents = children(0, cell / kBlockCells);
            const int i = static_cast<int>(cell % kBlockCells);
            if (!parents || parents->weight[i] <= 0) continue;
            ratio = parents->ratio(i);
        }
        for (int i = 0; i < kBlockCells; ++i) {
            if (blocks_[s].weight[i] <= 0) continue;
            blocks_[s].open[i] += weight * ratio;
            blocks_[s].weight[i] += weight;
        }
    }
}

void PooledVisibility::doubt(const Vec3f& axis, float angle) {
    const std::vector<CellCap>& caps = capsOf(tiers_.baseLevel());
    for (std::uint32_t c = 0; c < tiers_.baseCells(); ++c) {
        PooledBlock& base = base_[c / kBlockCells];
        const int lane = static_cast<int>(c % kBlockCells);
        if (!touches(caps[c], axis, angle) || !(base.open[lane] > 0)) continue;
        if (tiers_.refinements() == 0) {
            doubtCell(base, lane);
            continue;
        }
        PooledBlock& fine = childrenForDoubt(c);
        for (int i = 0; i < kBlockCells; ++i) {
            const std::uint32_t child = c * kBlockCells + static_cast<std::uint32_t>(i);
            if (!touches(capsOf(tiers_.baseLevel() + 2)[child], axis, angle)) continue;
            doubtCell(fine, i);
            if (tiers_.refinements() < 2) continue;
            const std::int16_t slot = slots_[tiers_.blockKey(1, child)];
            for (int k = 0; slot >= 0 && k < kBlockCells; ++k)
                doubtCell(blocks_[static_cast<std::size_t>(slot)], k);
        }
    }
}

/// The children of a base cell, made from the cell's own counts where no item has them.
PooledBlock& PooledVisibility::childrenForDoubt(std::uint32_t parent) {
    const std::uint16_t key = tiers_.blockKey(0, parent);
    if (slots_[key] < 0) {
        const PooledBlock& base = base_[parent / kBlockCells];
        const std::size_t lane = parent % kBlockCells;
        PooledBlock block{};
        std::fill_n(block.open, kBlockCells, base.open[lane]);
        std::fill_n(block.weight, kBlockCells, base.weight[lane]);
        std::fill_n(block.rays, kBlockCells, base.rays[lane]);
        std::fill_n(block.rays2, kBlockCells, base.rays2[lane]);
        slots_[key] = static_cast<std::int16_t>(blocks_.size());
        blocks_.push_back(block);
        counted_.push_back(1);
        countedOpen_.push_back(0);
        used_.push_back(key);
    }
    return blocks_[static_cast<std::size_t>(slots_[key])];
}

}  // namespace shadowcache
