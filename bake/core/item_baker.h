#pragma once

#include "bake/core/base_cells.h"
#include "bake/core/item_counts.h"
#include "bake/core/options.h"
#include "bake/core/variance_analysis.h"

namespace shadowcache {

/// Traces the rays of items. Each step is a function of the values of the steps before it
/// (item_counts.h): pilot rays, pilot rays of subpatches, counts. Thread-safe.
class ItemBaker {
public:
    /// Keeps references to `scene` and `options`.
    ItemBaker(const Scene& scene, const BakeOptions& options);

    const BaseCells& baseCells() const { return base_; }

    /// Pilot rays of a patch. Needs a level of at least 2.
    Pilot tracePilot(const Patch& patch) const;

    /// Pilot rays of the subpatches of a patch.
    Subdivision tracePilots(std::vector<Patch> subpatches) const;

    /// Counts of a patch that is not subdivided. Base cells are refined where directions explain
    /// the variance of their rays (variance_analysis.h). Those in `mixed` get more rays that decide
    /// about it; if there is none, the pilot's counts are all. The pilot rays of the subpatches
    /// count as well if the subpatches have about the same area.
    ItemCounts refine(const Patch& patch, const Pilot& pilot, const CellSet& mixed,
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
    enum class Step : std::uint64_t { pilot = 1, counts = 2 };

    RayCounter raysFrom(const Patch& patch, Step step) const;
    FineCounts traceFine(const Patch& patch, RayCounter& rays, BlockPairs& pairs) const;
    Pilot pilotOf(const Patch& patch, const FineCounts& fine, const RayCounter& rays) const;
    void addShots(RayCounter& rays, std::uint32_t cell, int count, Trial& trial) const;
    Trial traceTrial(const Patch& patch, const CellSet& mixed, const Subdivision& subdivision,
                     RayCounter& rays) const;
    Refined refineBase(const Patch& patch, const Pilot& pilot, const CellSet& mixed, Trial trial,
                       RayCounter& rays) const;
    std::vector<std::uint32_t> cellsToRefine(const Refined& first) const;
    std::vector<ItemCounts::Block> traceFinest(const std::vector<std::uint32_t>& cells, int count,
                                               RayCounter& rays) const;
    ItemCounts countsOf(std::vector<Count> base, const Refined& first,
                        const std::vector<ItemCounts::Block>& second, const RayCounter& rays) const;
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
