#include "bake/core/item_baker.h"

#include <algorithm>
#include <cmath>

#include "common/base/sequence.h"

namespace shadowcache {

namespace {

/// Rays into each region of the first refinement in an item that sees some sky, or whose neighbours
/// do;
constexpr int kProbeRays = 2;
/// and where a neighbour saw both sky and occluders in the base cell, so that a small opening may
/// hide.
constexpr int kSuspectRays = 6;
/// A region is refined once more where the nearest occluder is this many spacings away: nearer, the
/// parallax over one item blurs what finer regions could tell.
constexpr float kMinOccluderSpacings = 10;
/// Rays that look for one.
constexpr int kNearRays = 8;

constexpr std::uint32_t kOctet = DirectionTable::kCells;

/// Keeps the random numbers of a patch's rays apart from those of its origins.
constexpr std::uint64_t kRayNumbers = 0x72617973;

}  // namespace

BaseCells::BaseCells(const DirectionTiers& tiers) {
    for (std::uint32_t c = 0; c < tiers.baseCells(); ++c) {
        const SphericalTriangle t = cellTriangle(tiers.baseLevel(), c);
        const Vec3d center = cellCenter(tiers.baseLevel(), c);
        axis.emplace_back(center);
        const double least = std::min({center.dot(t.a), center.dot(t.b), center.dot(t.c)});
        radius.push_back(static_cast<float>(std::acos(least)));
    }
}

ItemBaker::ItemBaker(const Scene& scene, const DirectionTable& directions, const BaseCells& base,
                     const BakeOptions& options, double spacing)
    : rays_(scene, directions),
      base_(base),
      options_(options),
      tiers_{options.level},
      spacing_(static_cast<float>(spacing)),
      baseCounts_(std::size_t{(tiers_.baseCells() + kOctet - 1) / kOctet} * kOctet),
      fine_(tiers_.refinements() > 0 ? tiers_.baseCells() * kBlockCells : 0) {}

void ItemBaker::findCells(const Patch& patch) {
    const float spread = std::acos(std::clamp(patch.minAgreement, -1.0f, 1.0f));
    cells_.clear();
    for (std::uint32_t c = 0; c < tiers_.baseCells(); ++c) {
        const float angle = std::acos(std::clamp(base_.axis[c].dot(patch.normal), -1.0f, 1.0f));
        if (angle < static_cast<float>(kPi / 2) + spread + base_.radius[c]) cells_.push_back(c);
    }
}

/// Neighbouring items are pooled, so that the finest regions need fewer rays of each.
int ItemBaker::finestRays() const {
    return options_.adaptive ? std::max(1, options_.rays / 4) : options_.rays;
}

/// Queues rays into the sixteen cells of `level` that make up `parent`.
void ItemBaker::addBlock(int level, std::uint32_t parent, int count, Count* tallies) {
    rays_.add(level, 2 * parent, 0xff, count, tallies);
    rays_.add(level, 2 * parent + 1, 0xff, count, tallies + kBlockCells / 2);
}

void ItemBaker::addToFine(std::uint32_t cell, int count) {
    addBlock(tiers_.baseLevel() + 2, cell, count, fineOf(cell));
}

Count ItemBaker::sumWithProbe(std::uint32_t cell) {
    Count sum = baseCounts_[cell];
    sum += sumFine(cell);
    return sum;
}

Count ItemBaker::sumFine(std::uint32_t cell) {
    Count sum;
    for (int k = 0; k < kBlockCells; ++k) sum += fineOf(cell)[k];
    return sum;
}

Probe ItemBaker::probe(const Patch& patch) {
    rays_.start(patch, hashWords(patch.seed, kRayNumbers, 1));
    std::fill(fine_.begin(), fine_.end(), Count{});
    findCells(patch);
    for (const std::uint32_t c : cells_) addToFine(c, 1);
    rays_.flush();
    Probe probe;
    probe.normal = patch.normal;
    probe.position = patch.meanPosition;
    for (std::uint32_t c = 0; c < tiers_.baseCells(); ++c) {
        const Count sum = sumFine(c);
        probe.base.push_back(sum);
        probe.open[c] = sum.open() > 0;
        probe.blocked[c] = sum.open() < sum.rays();
    }
    return probe;
}

std::vector<Probe> ItemBaker::probeSubpatches(std::span<const Patch> subpatches) {
    subpatchFine_.assign(fine_.size(), Count{});
    std::vector<Probe> probes;
    for (const Patch& subpatch : subpatches) {
        probes.push_back(probe(subpatch));
        for (std::size_t i = 0; i < fine_.size(); ++i) subpatchFine_[i] += fine_[i];
    }
    return probes;
}

void ItemBaker::finish(const Patch& patch, const Vec3i& voxel, const Probe& probe,
                       const std::bitset<Probe::kCells>& mixed, bool countSubpatches,
                       CacheItems& out) {
    rays_.start(patch, hashWords(patch.seed, kRayNumbers, 2));
    std::fill(baseCounts_.begin(), baseCounts_.end(), Count{});
    if (countSubpatches)
        fine_ = subpatchFine_;
    else
        std::fill(fine_.begin(), fine_.end(), Count{});
    refined_.clear();
    if (!probe.base.empty()) std::copy(probe.base.begin(), probe.base.end(), baseCounts_.begin());
    findCells(patch);
    if (tiers_.refinements() == 0) {
        for (const std::uint32_t c : cells_)
            rays_.add(tiers_.baseLevel(), c / kOctet, 1u << c % kOctet, options_.rays,
                      &baseCounts_[c - c % kOctet]);
    } else if (!options_.adaptive || mixed.any()) {
        traceFine(mixed, countSubpatches ? 4 : 0);
    }
    rays_.flush();
    store(patch, voxel, out);
}

/// @param sofar  rays of every cell of the first refinement, but for those below a horizon
void ItemBaker::traceFine(const std::bitset<Probe::kCells>& mixed, int sofar) {
    const bool adaptive = options_.adaptive;
    const bool deeper = tiers_.refinements() > 1;
    const auto looks = [&](std::uint32_t c) {
        return std::max(sofar, std::min(mixed[c] ? kSuspectRays : kProbeRays, options_.rays));
    };
    if (adaptive) {
        for (const std::uint32_t c : cells_) addToFine(c, looks(c) - sofar);
        rays_.flush();
    }
    for (const std::uint32_t c : cells_) {
        if (adaptive && !sumWithProbe(c).mixed()) continue;
        refined_.push_back({tiers_.blockKey(0, c), c, {}});
        if (!deeper || adaptive)
            addToFine(c, std::max(0, options_.rays - (adaptive ? looks(c) : 0)));
    }
    rays_.flush();
    if (deeper) traceFinest();
}

/// Finds the cells of the first refinement that deserve a second one.
void ItemBaker::findFinest() {
    candidates_.clear();
    for (const Refined& r : refined_)
        for (std::uint32_t half = 0; half < kBlockCells; half += kOctet) {
            Candidates c{r.cell * kBlockCells + half, 0, {}};
            for (std::uint32_t k = 0; k < kOctet; ++k)
                if (!options_.adaptive || fineOf(r.cell)[half + k].mixed()) c.cells |= 1u << k;
            if (c.cells != 0) candidates_.push_back(c);
        }
    if (options_.adaptive)
        for (Candidates& c : candidates_)
            rays_.add(tiers_.baseLevel() + 2, c.first / kOctet, c.cells, kNearRays, c.near.data(),
                      kMinOccluderSpacings * spacing_);
    rays_.flush();
    for (const Candidates& c : candidates_)
        for (std::uint32_t k = 0; k < kOctet; ++k)
            if ((c.cells >> k & 1u) != 0 && c.near[k].open() == c.near[k].rays())
                refined_.push_back({tiers_.blockKey(1, c.first + k), c.first + k, {}});
}

void ItemBaker::traceFinest() {
    const std::size_t coarse = refined_.size();
    findFinest();
    // Queued tallies stay where they are: nothing is added to refined_ from here on.
    for (std::size_t i = coarse; i < refined_.size(); ++i)
        addBlock(tiers_.finest, refined_[i].cell, finestRays(), refined_[i].finest.data());
    rays_.flush();
    if (!options_.adaptive)
        for (std::size_t i = coarse; i < refined_.size(); ++i)
            for (const Count& count : refined_[i].finest) fine_[refined_[i].cell] += count;
}

void ItemBaker::store(const Patch& patch, const Vec3i& voxel, CacheItems& out) {
    out.voxel.push_back(voxel);
    out.patch.push_back(patch.code.packed());
    out.normal.push_back(patch.normal);
    out.position.push_back(patch.meanPosition);
    for (std::uint32_t c = 0; c < tiers_.baseCells(); ++c) {
        const Count sum = tiers_.refinements() > 0 ? sumWithProbe(c) : baseCounts_[c];
        out.n.push_back(0);
        out.d.push_back(0);
        addCounts(out.n.back(), out.d.back(), sum.open(), sum.rays());
    }
    for (const Refined& r : refined_) {
        const bool first = r.key < tiers_.blockKey(1, 0);
        const Count* counts = first ? fineOf(r.cell) : r.finest.data();
        CountBlock block{r.key, {}, {}};
        for (std::size_t k = 0; k < kBlockCells; ++k)
            addCounts(block.n[k], block.d[k], counts[k].open(), counts[k].rays());
        out.blocks.push_back(block);
    }
    out.firstBlock.push_back(static_cast<std::uint32_t>(out.blocks.size()));
}

}  // namespace shadowcache
