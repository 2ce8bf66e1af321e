#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "common/cache/shadow_cache.h"

namespace shadowcache::test {

/// An item whose counts are set one by one. Its views are valid until it changes.
class CountedItem {
public:
    explicit CountedItem(const DirectionTiers& tiers)
        : tiers_(tiers), n_(tiers.baseCells()), d_(tiers.baseCells()) {}

    /// Sets the counts of a base cell.
    CountedItem& base(std::uint32_t cell, unsigned n, unsigned d) {
        n_[cell] = static_cast<std::uint8_t>(n);
        d_[cell] = static_cast<std::uint8_t>(d);
        return *this;
    }
    /// Sets the counts of child `child` (0 .. 15) of a cell of a tier, which gets a block.
    CountedItem& child(int tier, std::uint32_t parent, std::size_t child, unsigned n, unsigned d) {
        Block& block = blocks_[tiers_.blockKey(tier, parent)];
        block.n[child] = static_cast<std::uint8_t>(n);
        block.d[child] = static_cast<std::uint8_t>(d);
        return *this;
    }

    ItemView view(float weight) {
        keys_.clear();
        packed_.clear();
        for (const auto& [key, block] : blocks_) {
            keys_.push_back(static_cast<std::int16_t>(key));
            packed_.push_back(block);
        }
        const Block* first = packed_.data();
        return {n_.data(),
                d_.data(),
                keys_.data(),
                first ? first->n.data() : nullptr,
                first ? first->d.data() : nullptr,
                sizeof(Block),
                sizeof(Block),
                static_cast<std::uint32_t>(keys_.size()),
                {0, 1, 0},
                weight,
                0};
    }

private:
    struct Block {
        std::array<std::uint8_t, kBlockCells> n{}, d{};
    };

    DirectionTiers tiers_;
    std::vector<std::uint8_t> n_, d_;
    std::map<std::uint16_t, Block> blocks_;
    std::vector<std::int16_t> keys_;
    std::vector<Block> packed_;
};

}  // namespace shadowcache::test
