#include "bake/core/item_baker.h"

#include <algorithm>

#include "bake/core/subpatches.h"
#include "common/base/tuned.h"
#include "common/random/salts.h"

namespace shadowcache {

namespace {

/// Rays into each region of the first refinement in an item that sees some sky, or whose neighbours
/// do.
SHADOWCACHE_TUNED(int, kMixedItemRays, 2);
/// The same where a neighbour saw both sky and occluders in the base cell, so that a small opening
/// may be there.
SHADOWCACHE_TUNED(int, kMixedCellRays, 6);
/// A region is refined once more where the nearest occluder is this many spacings away: nearer, the
/// parallax over one item blurs what finer regions could resolve.
SHADOWCACHE_TUNED(float, kMinOccluderSpacings, 10);
/// Rays that look for an occluder nearer than that.
SHADOWCACHE_TUNED(int, kNearRays, 8);

constexpr std::uint32_t kOctet = DirectionTable::kCells;

/// Queues rays into the sixteen cells of `level` that make up `parent`.
void addBlock(RayCounter& rays, int level, std::uint32_t parent, int count, Count* tallies) {
    rays.add(level, 2 * parent, 0xff, count, tallies);
    rays.add(level, 2 * parent + 1, 0xff, count, tallies + kBlockCells / 2);
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

}  // namespace

ItemBaker::ItemBaker(const Scene& scene, const BakeOptions& options, double spacing)
    : scene_(scene),
      options_(options),
      tiers_{options.level},
      base_(tiers_),
      spacing_(static_cast<float>(spacing)) {}

RayCounter ItemBaker::raysFrom(const Patch& patch, Step step) const {
    return {scene_, directions_, patch,
            hashWords(patch.seed, BakeSalt::rays, static_cast<std::uint64_t>(step))};
}

FineCounts ItemBaker::traceFine(const Patch& patch, RayCounter& rays) const {
    FineCounts fine = noFineCounts();
    for (const std::uint32_t c : base_.above(patch))
        addBlock(rays, tiers_.baseLevel() + 2, c, 1, childrenOf(fine, c));
    rays.flush();
    return fine;
}

Pilot ItemBaker::pilotOf(const Patch& patch, const FineCounts& fine, const RayCounter& rays) const {
    Pilot pilot;
    pilot.normal = patch.normal;
    pilot.position = patch.meanPosition;
    pilot.counts.reserve(tiers_.baseCells());
    for (std::uint32_t c = 0; c < tiers_.baseCells(); ++c) {
        const Count sum = sumOfChildren(fine, c);
        pilot.counts.push_back(sum);
        pilot.visible[c] = sum.visible() > 0;
        pilot.occluded[c] = sum.visible() < sum.rays();
    }
    pilot.rays = rays.raysTraced();
    return pilot;
}

Pilot ItemBaker::tracePilot(const Patch& patch) const {
    RayCounter rays = raysFrom(patch, Step::pilot);
    const FineCounts fine = traceFine(patch, rays);
    return pilotOf(patch, fine, rays);
}

Subdivision ItemBaker::tracePilots(std::vector<Patch> subpatches) const {
    Subdivision subdivision;
    subdivision.patches = std::move(subpatches);
    if (!subdivision.patches.empty()) subdivision.fine = noFineCounts();
    for (const Patch& patch : subdivision.patches) {
        RayCounter rays = raysFrom(patch, Step::pilot);
        const FineCounts fine = traceFine(patch, rays);
        for (std::size_t i = 0; i < fine.size(); ++i) subdivision.fine[i] += fine[i];
        subdivision.pilots.push_back(pilotOf(patch, fine, rays));
        subdivision.rays += rays.raysTraced();
    }
    return subdivision;
}

/// More rays into the cells of the first refinement, and most where base cells are mixed.
ItemBaker::Refined ItemBaker::refineBase(const Patch& patch, const Pilot& pilot,
                                         const CellSet& mixed, const Subdivision& subdivision,
                                         RayCounter& rays) const {
    const bool together = areAlikeInSize(subdivision.patches);
    Refined first{together ? subdivision.fine : noFineCounts(), {}};
    // Rays of every cell so far, but for those below a horizon.
    const int sofar = together ? static_cast<int>(subdivision.patches.size()) : 0;
    const auto wanted = [&](std::uint32_t c) {
        return std::max(sofar, std::min(mixed[c] ? kMixedCellRays : kMixedItemRays, options_.rays));
    };
    const auto add = [&](std::uint32_t c, int count) {
        addBlock(rays, tiers_.baseLevel() + 2, c, count, childrenOf(first.fine, c));
    };
    const std::vector<std::uint32_t> cells = base_.above(patch);
    for (const std::uint32_t c : cells) add(c, wanted(c) - sofar);
    rays.flush();
    for (const std::uint32_t c : cells) {
        Count sum = pilot.counts[c];
        sum += sumOfChildren(first.fine, c);
        if (sum.mixed()) first.cells.push_back(c);
    }
    for (const std::uint32_t c : first.cells) add(c, std::max(0, options_.rays - wanted(c)));
    rays.flush();
    return first;
}

/// Cells of the first refinement to refine once more: mixed ones without a near occluder.
std::vector<std::uint32_t> ItemBaker::cellsToRefine(const Refined& first, RayCounter& rays) const {
    /// Of the cells octet * 8 .. octet * 8 + 7 those whose bit is set.
    struct Candidates {
        std::uint32_t octet;
        std::uint32_t cells;
        std::array<Count, kOctet> near;  ///< rays that met nothing near are visible
    };
    std::vector<Candidates> candidates;
    for (const std::uint32_t parent : first.cells)
        for (std::uint32_t half = 0; half < kBlockCells / kOctet; ++half) {
            Candidates c{parent * (kBlockCells / kOctet) + half, 0, {}};
            for (std::uint32_t k = 0; k < kOctet; ++k)
                if (first.fine[c.octet * kOctet + k].mixed()) c.cells |= 1u << k;
            if (c.cells != 0) candidates.push_back(c);
        }
    for (Candidates& c : candidates)
        rays.add(tiers_.baseLevel() + 2, c.octet, c.cells, kNearRays, c.near.data(),
                 kMinOccluderSpacings * spacing_);
    rays.flush();
    std::vector<std::uint32_t> cells;
    for (const Candidates& c : candidates)
        for (std::uint32_t k = 0; k < kOctet; ++k)
            if ((c.cells >> k & 1u) != 0 && c.near[k].visible() == c.near[k].rays())
                cells.push_back(c.octet * kOctet + k);
    return cells;
}

/// Traces `count` rays into each of the sixteen finest cells in each of `cells`.
std::vector<ItemCounts::Block> ItemBaker::traceFinest(const std::vector<std::uint32_t>& cells,
                                                      int count, RayCounter& rays) const {
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
                               const RayCounter& rays) const {
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

ItemCounts ItemBaker::refine(const Patch& patch, const Pilot& pilot, const CellSet& mixed,
                             const Subdivision& subdivision) const {
    if (mixed.none()) return {pilot.counts, {}, 0};
    RayCounter rays = raysFrom(patch, Step::counts);
    const Refined first = refineBase(patch, pilot, mixed, subdivision, rays);
    std::vector<ItemCounts::Block> second;
    // Neighbouring items are pooled, so that the finest regions need fewer rays of each.
    if (tiers_.refinements() > 1)
        second = traceFinest(cellsToRefine(first, rays), std::max(1, options_.rays / 4), rays);
    return countsOf(pilot.counts, first, second, rays);
}

ItemCounts ItemBaker::countUniformly(const Patch& patch) const {
    RayCounter rays = raysFrom(patch, Step::counts);
    const std::vector<std::uint32_t> cells = base_.above(patch);
    // Rays are counted by whole octets.
    std::vector<Count> base((tiers_.baseCells() + kOctet - 1) / kOctet * kOctet);
    if (tiers_.refinements() == 0) {
        for (const std::uint32_t c : cells)
            rays.add(tiers_.baseLevel(), c / kOctet, 1u << c % kOctet, options_.rays,
                     &base[c - c % kOctet]);
        rays.flush();
        base.resize(tiers_.baseCells());
        return {std::move(base), {}, rays.raysTraced()};
    }
    base.resize(tiers_.baseCells());
    Refined all{noFineCounts(), cells};
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
