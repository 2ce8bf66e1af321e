#pragma once

#include <concepts>
#include <cstdint>
#include <span>
#include <vector>

#include "common/predict/cell_splits.h"
#include "common/predict/lanes.h"
#include "common/predict/pooled_visibility.h"
#include "render/regions/cell_visibility.h"
#include "render/regions/regions.h"

namespace shadowcache {

/// Sixteen consecutive cells of a tier of the cache.
struct CellBlock {
    int tier;
    int level;
    std::uint32_t number;  ///< of its level: cells 16 number .. 16 number + 15
    const CellMoments& light;
};

/// What the light is multiplied with before it is integrated, for a cluster of points: the cosine,
/// or a lobe. Fit is what stands in for it in sixteen cells, Scratch what is found out of them.
template <class I>
concept Integrand = requires(const I& integrand, const CellBlock& block,
                             typename I::Scratch& scratch, const CellVisibility& visibility,
                             const PooledVisibility& pooled, Splits& splits,
                             RegionEvidence& evidence, typename I::Fit& fit,
                             const typename I::Points& points, std::uint32_t point,
                             const Vec3f& w) {
    /// Looks at the cells; false: all of them are below the horizon of every point.
    { integrand.look(block, scratch) } -> std::same_as<bool>;
    /// Marks the cells that are to be split.
    integrand.split(block, visibility, pooled, scratch, splits);
    /// Sets what the cells that are not split are as regions, but the visibility.
    integrand.describe(block, splits, scratch, evidence);
    /// Sets what stands in for the integrand in them.
    integrand.fit(block, scratch, fit);
};

/// Regions, and what stands in for the integrand there.
template <class I>
struct FittedRegions {
    Regions regions;
    std::vector<typename I::Fit> fits;  ///< as Regions::groups
};

/// Makes regions of pooled counts. Its buffers are used again from call to call.
template <Integrand I>
class RegionBuilder {
public:
    RegionBuilder(const Environment& environment, const DirectionTiers& tiers)
        : environment_(environment), tiers_(tiers) {}

    /// Regions in which every direction lies that the integrand of some point makes light of.
    ///
    /// @return valid until the next call
    const FittedRegions<I>& build(const I& integrand, const PooledVisibility& pooled,
                                  const Calibration& calibration) {
        result_.regions.clear();
        result_.fits.clear();
        evidence_.clear();
        const ParentVisibility sphere = sphereVisibility(pooled);
        const Task task{integrand, pooled, calibration};
        for (std::uint32_t b = 0; b < pooled.baseBlocks(); ++b)
            addBlock(task, 0, b, &pooled.base(b), sphere);
        return result_;
    }

    /// What the groups of the last build() are made of.
    std::span<const RegionEvidence> evidence() const { return evidence_; }

private:
    struct Task {
        const I& integrand;
        const PooledVisibility& pooled;
        const Calibration& calibration;
    };

    void addBlock(const Task& task, int tier, std::uint32_t number, const PooledBlock* counts,
                  const ParentVisibility& parent) {
        const int level = tiers_.baseLevel() + 2 * tier;
        const CellBlock block{tier, level, number, environment_.cells(level, number)};
        typename I::Scratch scratch;
        if (!task.integrand.look(block, scratch)) return;
        CellVisibility v;
        estimateVisibility(counts, parent, v);
        Splits splits;
        task.integrand.split(block, v, task.pooled, scratch, splits);

        RegionEvidence& evidence = evidence_.emplace_back();
        evidence.firstCell = number * kBlockCells;
        evidence.level = level;
        for (int i = 0; i < kBlockCells; ++i) {
            evidence.counted[i] = v.c[i];
            evidence.posterior[i] = v.posterior[i];
        }
        task.integrand.describe(block, splits, scratch, evidence);
        if (maximumOf(evidence.light) > 0) {
            task.integrand.fit(block, scratch, result_.fits.emplace_back());
            result_.regions.add(evidence, task.calibration);
        } else {
            evidence_.pop_back();
        }
        splits.forEach([&](int i) {
            const std::uint32_t cell = number * kBlockCells + static_cast<std::uint32_t>(i);
            addBlock(task, tier + 1, cell, task.pooled.children(tier, cell),
                     {v.c[i], v.posterior[i]});
        });
    }

    const Environment& environment_;
    DirectionTiers tiers_;
    FittedRegions<I> result_;
    std::vector<RegionEvidence> evidence_;
};

}  // namespace shadowcache
