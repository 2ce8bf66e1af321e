#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <optional>

#include "common/cache/shadow_cache.h"

namespace shadowcache {

/// Counts as a tree: blocks of sixteen base cells, and finer blocks below cells that have them.
/// children() gives a pointer or an optional; PooledVisibility and ItemCountTree are such trees.
template <class T>
concept CountTree = requires(const T& tree, int tier, std::uint32_t index) {
    { tree.tiers() } -> std::convertible_to<DirectionTiers>;
    tree.base(index);
    { tree.hasChildren(tier, index) } -> std::same_as<bool>;
    *tree.children(tier, index);
    static_cast<bool>(tree.children(tier, index));
};

/// The counts of one item as a tree, as long as the item's view is valid. Thread-safe.
class ItemCountTree {
public:
    ItemCountTree(const ItemView& item, const DirectionTiers& tiers) : item_(item), tiers_(tiers) {
        const std::uint32_t cells = tiers.baseCells();
        for (std::uint32_t c = cells - cells % kBlockCells; c < cells; ++c) {
            restN_[c % kBlockCells] = item.n[c];
            restD_[c % kBlockCells] = item.d[c];
        }
    }

    const DirectionTiers& tiers() const { return tiers_; }
    /// Base cells 16 block .. 16 block + 15; cells that do not exist have no rays.
    BlockCounts base(std::uint32_t block) const {
        const std::uint32_t first = block * kBlockCells;
        if (first + kBlockCells > tiers_.baseCells()) return {restN_.data(), restD_.data()};
        return {item_.n + first, item_.d + first};
    }
    /// Whether cell `cell` of a tier has finer counts.
    bool hasChildren(int tier, std::uint32_t cell) const { return find(tier, cell) >= 0; }
    /// Children of that cell.
    std::optional<BlockCounts> children(int tier, std::uint32_t cell) const {
        const int found = find(tier, cell);
        if (found < 0) return {};
        return item_.block(static_cast<std::size_t>(found));
    }

private:
    ItemView item_;
    DirectionTiers tiers_;
    std::array<std::uint8_t, kBlockCells> restN_{}, restD_{};  ///< the last 4 of 20 base cells

    int find(int tier, std::uint32_t cell) const {
        return tier < tiers_.refinements() ? item_.findBlock(tiers_.blockKey(tier, cell)) : -1;
    }
};
static_assert(CountTree<ItemCountTree>);

/// The step of walk(): sixteen cells, and those below them that the visitor asks for.
template <CountTree Tree, class Counts, class State, class Visit>
void walkBlock(const Tree& tree, int tier, std::uint32_t block, const Counts& counts,
               const State& state, Visit& visit) {
    visit(tier, block, counts, state, [&](int i, const State& below) {
        const std::uint32_t cell = block * kBlockCells + static_cast<std::uint32_t>(i);
        walkBlock(tree, tier + 1, cell, tree.children(tier, cell), below, visit);
    });
}

/// Walks down a tree of counts, depth first. `visit(tier, block, counts, state, descend)` sees the
/// cells 16 block .. 16 block + 15 of a tier: `*counts` are theirs, if `counts` is not null, and
/// `state` is what their parent handed down, `root` at the base. It calls `descend(i, state)` for
/// each of the sixteen to go on with, whether it has finer counts or not.
template <CountTree Tree, class State, class Visit>
void walk(const Tree& tree, const State& root, Visit visit) {
    for (std::uint32_t b = 0; b < tree.tiers().baseBlocks(); ++b) {
        const auto& base = tree.base(b);
        walkBlock(tree, 0, b, &base, root, visit);
    }
}

/// Goes down a tree of counts towards cell `cell` of `level`, as far as there are counts.
/// `step(tier, counts, first, count)` sees cells `first` .. `first + count - 1` of a block of that
/// tier: the one that holds the cell, or at last the four that lie in it.
template <CountTree Tree, class Step>
void descend(const Tree& tree, int level, std::uint32_t cell, const Step& step) {
    const DirectionTiers& tiers = tree.tiers();
    std::uint32_t parent = 0;
    for (int tier = 0; tier <= tiers.refinements(); ++tier) {
        const int finer = tiers.levelOf(tier);
        if (tier > 0 && level < finer - 1) return;
        const bool holds = level >= finer;
        const std::uint32_t at = holds ? ancestorCell(cell, level, finer) : 4 * cell;
        const auto take = [&](const auto& counts) {
            step(tier, counts, static_cast<int>(at % kBlockCells), holds ? 1 : 4);
        };
        if (tier == 0) {
            take(tree.base(at / kBlockCells));
        } else {
            const auto& counts = tree.children(tier - 1, parent);
            if (!counts) return;
            take(*counts);
        }
        if (!holds) return;
        parent = at;
    }
}

}  // namespace shadowcache
