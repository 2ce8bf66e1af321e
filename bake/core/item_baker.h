#pragma once

#include <bitset>
#include <span>
#include <vector>

#include "bake/core/options.h"
#include "bake/core/ray_counter.h"
#include "common/cache/cache_items.h"

namespace shadowcache {

/// Geometry of the base cells, for skipping those below a patch's horizon.
struct BaseCells {
    explicit BaseCells(const DirectionTiers& tiers);

    std::vector<Vec3f> axis;
    std::vector<float> radius;  ///< angle around the axis that holds the cell [rad]
};

/// What the first rays of an item found, by base cell.
struct Probe {
    static constexpr std::size_t kCells = cellCount(1);

    Vec3f normal;
    Vec3f position;               ///< of the patch, as Patch::meanPosition
    std::bitset<kCells> open;     ///< a ray reached the sky
    std::bitset<kCells> blocked;  ///< a ray did not
    std::vector<Count> base;      ///< rays so far; empty where nothing can be mixed
};

/// Traces the rays of items, one after another; one for each thread.
class ItemBaker {
public:
    ItemBaker(const Scene& scene, const DirectionTable& directions, const BaseCells& base,
              const BakeOptions& options, double spacing);

    /// The first pass: one ray into every region of the first refinement.
    Probe probe(const Patch& patch);

    /// The first pass of a patch's subpatches.
    std::vector<Probe> probeSubpatches(std::span<const Patch> subpatches);

    /// Appends the finished item. Base cells in `mixed` get more rays, whatever the item's own
    /// first ones say; without any, the probe is all there is to know. With
    /// `countSubpatches` the rays of the subpatches that were probed last, four of this patch,
    /// count as well.
    void finish(const Patch& patch, const Vec3i& voxel, const Probe& probe,
                const std::bitset<Probe::kCells>& mixed, bool countSubpatches, CacheItems& out);

    std::uint64_t raysTraced() const { return rays_.raysTraced(); }

private:
    /// Counts of the children of one refined cell.
    struct Refined {
        std::uint16_t key;
        std::uint32_t cell;
        std::array<Count, kBlockCells> finest;  ///< second refinement only; the first is in fine_
    };

    /// Cells of the first refinement that may be refined once more: of first .. first + 7, those
    /// whose bit is set.
    struct Candidates {
        std::uint32_t first;
        std::uint32_t cells;
        std::array<Count, DirectionTable::kCells> near;  ///< rays that met nothing near
    };

    void findCells(const Patch& patch);
    int finestRays() const;
    Count* fineOf(std::uint32_t cell) { return &fine_[std::size_t{cell} * kBlockCells]; }
    void addBlock(int level, std::uint32_t parent, int count, Count* tallies);
    void addToFine(std::uint32_t cell, int count);
    Count sumFine(std::uint32_t cell);
    /// Rays of both passes.
    Count sumWithProbe(std::uint32_t cell);
    void traceFine(const std::bitset<Probe::kCells>& mixed, int sofar);
    void findFinest();
    void traceFinest();
    void store(const Patch& patch, const Vec3i& voxel, CacheItems& out);

    RayCounter rays_;
    const BaseCells& base_;
    const BakeOptions& options_;
    DirectionTiers tiers_;
    float spacing_;
    std::vector<std::uint32_t> cells_;  ///< base cells not wholly below the patch's horizon
    std::vector<Count> baseCounts_;
    std::vector<Count> fine_;          ///< of the first refinement
    std::vector<Count> subpatchFine_;  ///< the same of the subpatches that were probed last
    std::vector<Refined> refined_;
    std::vector<Candidates> candidates_;
};

}  // namespace shadowcache
