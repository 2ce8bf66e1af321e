#include "bake/core/item_baker.h"

#include <algorithm>

#include "bake/core/subpatches.h"
#include "common/base/tuned.h"
#include "common/random/salts.h"

namespace shadowcache {

namespace {

/// Rays into each region of the first refinement that decide whether its base cell is refined.
SHADOWCACHE_TUNED(int, kTrialShots, 3);
/// The same where no probe ray of the item or of its neighbours disagreed.
constexpr int kUnmixedShots = 1;
/// The same where some did, but too few rays of the item (kFewRays): a small opening may be there.
SHADOWCACHE_TUNED(int, kSearchShots, 12);
/// Rays of a base cell that must be visible, and as many occluded, for an analysis of its variance.
SHADOWCACHE_TUNED(std::uint32_t, kFewRays, 8);
/// Base cells with fewer are searched and refined if directions explain this share of the variance
/// in the item's others: not among leaves, where other origins see other gaps.
SHADOWCACHE_TUNED(double, kLeastShare, 0.35);
/// A base cell is refined where that lowers the deviation of a ray's visibility by more than this.
SHADOWCACHE_TUNED(double, kLeastGain, 0.06);
/// And once more where it lowers it by more than this.
SHADOWCACHE_TUNED(double, kLeastGainAgain, 0.28);

constexpr std::uint32_t kOctet = DirectionTable::kCells;

/// Queues rays into the sixteen cells of `level` that make up `parent`.
void addBlock(VisibilityCounter& rays, int level, std::uint32_t parent, int count, Count* tallies,
              OriginPairs* pairs = nullptr) {
    rays.add(level, 2 * parent, 0xff, count, tallies, pairs);
    rays.add(level, 2 * parent + 1, 0xff, count, tallies + kBlockCells / 2, pairs);
}

/// Counts of the children of a cell.
Count* childrenOf(FineCounts& fine, std::uint32_t cell) {
    return &fine[std::size_t{cell} * kBlockCells];
}

template <class Cells>
Count sumOf(const Cells& cells, std::size_t first = 0) {
    Count sum;
    for (std::size_t k = 0; k < kBlockCells; ++k) sum += cells[first + k];
    return sum;
}

Count sumOfChildren(const FineCounts& fine, std::uint32_t cell) {
    return sumOf(fine, std::size_t{cell} * kBlockCells);
}

/// Whether too few rays disagree to say anything about where.
bool isFew(const Count& count) {
    return std::min(count.visible(), count.rays() - count.visible()) < kFewRays;
}

}  // namespace

ItemBaker::ItemBaker(const Scene& scene, const BakeOptions& options)
    : scene_(scene), options_(options), tiers_{options.level}, base_(tiers_) {}

VisibilityCounter ItemBaker::raysFrom(const Patch& patch, Step step) const {
    return {scene_, directions_, patch,
            hashWords(patch.seed, BakeSalt::rays, static_cast<std::uint64_t>(step))};
}

void ItemBaker::addShots(VisibilityCounter& rays, std::uint32_t cell, int count,
                         Trial& trial) const {
    addBlock(rays, tiers_.baseLevel() + 2, cell, std::max(0, count), childrenOf(trial.fine, cell),
             &trial.pairs[cell]);
}

VarianceAnalysis ItemBaker::Trial::analyse(std::uint32_t cell) const {
    return analyseVariance({&fine[std::size_t{cell} * kBlockCells], kBlockCells}, pairs[cell]);
}

int ItemBaker::Trial::shots(std::uint32_t cell) const {
    std::uint32_t most = 0;
    for (std::size_t k = 0; k < kBlockCells; ++k)
        most = std::max(most, fine[std::size_t{cell} * kBlockCells + k].rays());
    return static_cast<int>(most);
}

FineCounts ItemBaker::traceFine(const Patch& patch, VisibilityCounter& rays,
                                BlockPairs& pairs) const {
    FineCounts fine = noFineCounts();
    pairs.resize(tiers_.baseCells());
    for (const std::uint32_t c : base_.above(patch))
        addBlock(rays, tiers_.baseLevel() + 2, c, 1, childrenOf(fine, c), &pairs[c]);
    rays.flush();
    return fine;
}

Probe ItemBaker::probeOf(const Patch& patch, const FineCounts& fine,
                         const VisibilityCounter& rays) const {
    Probe probe;
    probe.normal = patch.normal;
    probe.position = patch.meanPosition;
    probe.counts.reserve(tiers_.baseCells());
    for (std::uint32_t c = 0; c < tiers_.baseCells(); ++c) {
        const Count sum = sumOfChildren(fine, c);
        probe.counts.push_back(sum);
        probe.visible[c] = sum.visible() > 0;
        probe.occluded[c] = sum.visible() < sum.rays();
    }
    probe.rays = rays.raysTraced();
    return probe;
}

Probe ItemBaker::traceProbe(const Patch& patch) const {
    VisibilityCounter rays = raysFrom(patch, Step::probe);
    BlockPairs pairs;
    const FineCounts fine = traceFine(patch, rays, pairs);
    return probeOf(patch, fine, rays);
}

Subdivision ItemBaker::traceProbes(std::vector<Patch> subpatches) const {
    Subdivision subdivision;
    subdivision.patches = std::move(subpatches);
    if (!subdivision.patches.empty()) subdivision.fine = noFineCounts();
    for (const Patch& patch : subdivision.patches) {
        VisibilityCounter rays = raysFrom(patch, Step::probe);
        const FineCounts fine = traceFine(patch, rays, subdivision.pairs);
        for (std::size_t i = 0; i < fine.size(); ++i) subdivision.fine[i] += fine[i];
        subdivision.probes.push_back(probeOf(patch, fine, rays));
        subdivision.rays += rays.raysTraced();
    }
    return subdivision;
}

/// The first rays into the cells of the first refinement; those of subpatches of one size are some.
ItemBaker::Trial ItemBaker::traceTrial(const Patch& patch, const CellSet& mixed,
                                       const Subdivision& subdivision,
                                       VisibilityCounter& rays) const {
    Trial trial{noFineCounts(), BlockPairs(tiers_.baseCells())};
    int sofar = 0;
    if (areAlikeInSize(subdivision.patches)) {
        trial = {subdivision.fine, subdivision.pairs};
        sofar = static_cast<int>(subdivision.patches.size());
    }
    for (const std::uint32_t c : base_.above(patch))
        addShots(rays, c, (mixed[c] ? kTrialShots : kUnmixedShots) - sofar, trial);
    rays.flush();
    return trial;
}

/// Adds rays where few disagree, and refines base cells where directions explain enough.
ItemBaker::Refined ItemBaker::refineBase(const Patch& patch, const Probe& probe,
                                         const CellSet& mixed, Trial trial,
                                         VisibilityCounter& rays) const {
    const std::vector<std::uint32_t> cells = base_.above(patch);
    const auto countOf = [&](std::uint32_t c) {
        Count sum = probe.counts[c];
        sum += sumOfChildren(trial.fine, c);
        return sum;
    };
    double explained = 0, variance = 0;
    for (const std::uint32_t c : cells) {
        if (isFew(countOf(c))) continue;
        const VarianceAnalysis found = trial.analyse(c);
        explained += found.directions;
        variance += found.mean * (1 - found.mean);
    }
    const bool search = explained >= kLeastShare * variance;
    for (const std::uint32_t c : cells)
        if (search && mixed[c] && isFew(countOf(c)))
            addShots(rays, c, std::min(kSearchShots, options_.rays) - trial.shots(c), trial);
    rays.flush();

    Refined first;
    for (const std::uint32_t c : cells) {
        const Count count = countOf(c);
        const bool few = isFew(count);
        if (!count.mixed() || (few && !search)) continue;
        const double gain = trial.analyse(c).gain();
        if (gain <= kLeastGain && !few) continue;
        first.cells.push_back(c);
        if (gain > kLeastGainAgain) first.again.push_back(c);
    }
    for (const std::uint32_t c : first.cells)
        addShots(rays, c, options_.rays - trial.shots(c), trial);
    rays.flush();
    first.fine = std::move(trial.fine);
    return first;
}

/// Cells of the first refinement to refine once more: the mixed ones.
std::vector<std::uint32_t> ItemBaker::cellsToRefine(const Refined& first) const {
    std::vector<std::uint32_t> cells;
    for (const std::uint32_t parent : first.again)
        for (std::uint32_t k = parent * kBlockCells; k < (parent + 1) * kBlockCells; ++k)
            if (first.fine[k].mixed()) cells.push_back(k);
    return cells;
}

/// Traces `count` rays into each of the sixteen finest cells in each of `cells`.
std::vector<ItemCounts::Block> ItemBaker::traceFinest(const std::vector<std::uint32_t>& cells,
                                                      int count, VisibilityCounter& rays) const {
    std::vector<ItemCounts::Block> blocks;
    blocks.reserve(cells.size());
    for (const std::uint32_t cell : cells) blocks.push_back({tiers_.blockKey(1, cell), {}});
    // Queued tallies stay where they are from here on.
    for (std::size_t i = 0; i < cells.size(); ++i)
        addBlock(rays, tiers_.finest, cells[i], count, blocks[i].cells.data());
    rays.flush();
    return blocks;
}

/// Adds the first refinement to the counts of the base cells, and lists the blocks of both.
ItemCounts ItemBaker::countsOf(std::vector<Count> base, const Refined& first,
                               const std::vector<ItemCounts::Block>& second,
                               const VisibilityCounter& rays) const {
    ItemCounts counts{std::move(base), {}, rays.raysTraced()};
    for (std::uint32_t c = 0; c < tiers_.baseCells(); ++c)
        counts.base[c] += sumOfChildren(first.fine, c);
    counts.blocks.reserve(first.cells.size() + second.size());
    for (const std::uint32_t c : first.cells) {
        ItemCounts::Block block{tiers_.blockKey(0, c), {}};
        std::copy_n(first.fine.begin() + std::ptrdiff_t{c} * kBlockCells, kBlockCells,
                    block.cells.begin());
        counts.blocks.push_back(block);
    }
    counts.blocks.insert(counts.blocks.end(), second.begin(), second.end());
    return counts;
}

ItemCounts ItemBaker::refine(const Patch& patch, const Probe& probe, const CellSet& mixed,
                             const Subdivision& subdivision) const {
    if (mixed.none()) return {probe.counts, {}, 0};
    VisibilityCounter rays = raysFrom(patch, Step::counts);
    const Refined first =
        refineBase(patch, probe, mixed, traceTrial(patch, mixed, subdivision, rays), rays);
    std::vector<ItemCounts::Block> second;
    // Neighbouring items are pooled, so that the finest regions need fewer rays of each.
    if (tiers_.refinements() > 1)
        second = traceFinest(cellsToRefine(first), std::max(1, options_.rays / 4), rays);
    return countsOf(probe.counts, first, second, rays);
}

ItemCounts ItemBaker::countUniformly(const Patch& patch) const {
    VisibilityCounter rays = raysFrom(patch, Step::counts);
    const std::vector<std::uint32_t> cells = base_.above(patch);
    // Rays are counted by whole octets.
    const std::size_t octets = (tiers_.baseCells() + kOctet - 1) / kOctet;
    std::vector<Count> base(octets * kOctet);
    if (tiers_.refinements() == 0) {
        for (const std::uint32_t c : cells)
            rays.add(tiers_.baseLevel(), c / kOctet, 1u << c % kOctet, options_.rays,
                     &base[c - c % kOctet]);
        rays.flush();
        base.resize(tiers_.baseCells());
        return {std::move(base), {}, rays.raysTraced()};
    }
    base.resize(tiers_.baseCells());
    Refined all{noFineCounts(), cells, {}};
    if (tiers_.refinements() == 1) {
        for (const std::uint32_t c : cells)
            addBlock(rays, tiers_.finest, c, options_.rays, childrenOf(all.fine, c));
        rays.flush();
        return countsOf(std::move(base), all, {}, rays);
    }
    std::vector<std::uint32_t> fineCells;
    for (const std::uint32_t c : cells)
        for (std::uint32_t k = 0; k < kBlockCells; ++k) fineCells.push_back(c * kBlockCells + k);
    const std::vector<ItemCounts::Block> second = traceFinest(fineCells, options_.rays, rays);
    for (std::size_t i = 0; i < second.size(); ++i) all.fine[fineCells[i]] = sumOf(second[i].cells);
    return countsOf(std::move(base), all, second, rays);
}

}  // namespace shadowcache
