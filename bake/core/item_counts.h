#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <vector>

#include "bake/core/patch.h"
#include "bake/core/visibility_counter.h"
#include "common/cache/cache_items.h"

namespace shadowcache {

/// Base cells of the direction mesh; bit c stands for cell c.
using CellSet = std::bitset<cellCount(1)>;

/// Counts of the cells of the first refinement; empty stands for no rays.
using FineCounts = std::vector<Count>;

/// Pairs of rays of the first refinement that share an origin, by base cell.
using BlockPairs = std::vector<OriginPairs>;

// What the steps of an item find. ItemBaker decides how many rays (item_baker.h), VisibilityCounter
// traces and counts them (visibility_counter.h), and they are stored as n and d.

/// Step 1 of an item: one probe ray into every cell of the first refinement, by base cell.
struct Probe {
    Vec3f normal;
    Vec3f position;               ///< of the patch, as Patch::meanPosition
    CellSet visible{};            ///< a ray reached the sky
    CellSet occluded{};           ///< a ray did not
    std::vector<Count> counts{};  ///< by base cell
    std::uint64_t rays = 0;       ///< traced

    CellSet mixed() const { return visible & occluded; }
};

/// Step 2: the subpatches of a patch, with probe rays of their own.
struct Subdivision {
    std::vector<Patch> patches;  ///< as makeSubpatches makes them
    std::vector<Probe> probes;   ///< of each
    FineCounts fine;             ///< the probe rays of all of them
    BlockPairs pairs;            ///< of them
    std::uint64_t rays = 0;      ///< traced
};

/// Step 3: all counts of an item.
struct ItemCounts {
    struct Block {
        std::uint16_t key;  ///< DirectionTiers::blockKey
        std::array<Count, kBlockCells> cells;
    };

    std::vector<Count> base;    ///< by base cell
    std::vector<Block> blocks;  ///< finer counts of refined cells, in the order of their keys
    std::uint64_t rays = 0;     ///< traced in this step
};

/// Step 4: rounds the counts to 8 bits and appends the item.
void store(const ItemCounts& counts, const Patch& patch, const Vec3i& voxel, CacheItems& out);

}  // namespace shadowcache
