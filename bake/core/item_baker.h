#pragma once

#include "bake/core/base_cells.h"
#include "bake/core/item_counts.h"
#include "bake/core/options.h"
#include "bake/core/variance_analysis.h"

namespace shadowcache {

/// Traces the rays of items. Each step is a function of the values of the steps before it
/// (item_counts.h): probe rays, probe rays of subpatches, counts. Thread-safe.
class ItemBaker {
public:
    /// Keeps references to `scene` and `options`.
    ItemBaker(const Scene& scene, const BakeOptions& options);

    const BaseCells& baseCells() const { return base_; }

    /// Probe rays of a patch. Needs a level of at least 2.
    Probe traceProbe(const Patch& patch) const;

    /// Probe rays of the subpatches of a patch.
    Subdivision traceProbes(std::vector<Patch> subpatches) const;

    /// Counts of a patch that is not subdivided. Base cells are refined where directions explain
    /// the variance of their rays (variance_analysis.h). Those in `mixed` get more rays that decide
    /// about it; if there is none, the probe's counts are all. The probe rays of the subpatches
    /// count as well if the subpatches have about the same area.
    ItemCounts refine(const Patch& patch, const Probe& probe, const CellSet& mixed,
                      const Subdivision& subdivision) const;

    /// Counts of a patch with the same number of rays in every region of the finest level.
    ItemCounts countUniformly(const Patch& patch) const;

private:
    /// Rays into the cells of the first refinement, from which its base cells are judged.
    struct Trial {
        FineCounts fine;
        BlockPairs pairs;

        VarianceAnalysis analyse(std::uint32_t cell) const;
        int shots(std::uint32_t cell) const;  ///< rays into each region of a base cell, at most
    };

    /// The first refinement of an item.
    struct Refined {
        FineCounts fine;
        std::vector<std::uint32_t> cells;  ///< base cells whose finer counts are kept
        std::vector<std::uint32_t> again;  ///< of those the ones to refine once more
    };

    /// Steps whose rays are drawn independently.
    enum class Step : std::uint64_t { probe = 1, counts = 2 };

    VisibilityCounter raysFrom(const Patch& patch, Step step) const;
    FineCounts traceFine(const Patch& patch, VisibilityCounter& rays, BlockPairs& pairs) const;
    Probe probeOf(const Patch& patch, const FineCounts& fine, const VisibilityCounter& rays) const;
    void addShots(VisibilityCounter& rays, std::uint32_t cell, int count, Trial& trial) const;
    Trial traceTrial(const Patch& patch, const CellSet& mixed, const Subdivision& subdivision,
                     VisibilityCounter& rays) const;
    Refined refineBase(const Patch& patch, const Probe& probe, const CellSet& mixed, Trial trial,
                       VisibilityCounter& rays) const;
    std::vector<std::uint32_t> cellsToRefine(const Refined& first) const;
    std::vector<ItemCounts::Block> traceFinest(const std::vector<std::uint32_t>& cells, int count,
                                               VisibilityCounter& rays) const;
    ItemCounts countsOf(std::vector<Count> base, const Refined& first,
                        const std::vector<ItemCounts::Block>& second,
                        const VisibilityCounter& rays) const;
    FineCounts noFineCounts() const {
        return FineCounts(std::size_t{tiers_.baseCells()} * kBlockCells);
    }

    const Scene& scene_;
    const BakeOptions& options_;
    DirectionTiers tiers_;
    DirectionTable directions_;
    BaseCells base_;
};

}  // namespace shadowcache
