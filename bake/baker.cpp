#include "bake/baker.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "bake/ray_counter.h"
#include "common/error.h"
#include "common/parallel.h"
#include "common/progress.h"
#include "common/sequence.h"
#include "common/version.h"

namespace shadowcache {

namespace {

/// Rays per region of the first refinement in the first pass, which finds out where rays disagree.
constexpr int kProbeRays = 2;
/// A region is refined once more where the nearest occluder is this many spacings away: nearer, the parallax
/// over one item blurs what finer regions could tell.
constexpr float kMinOccluderSpacings = 10;

/// Geometry of the base cells, for skipping those below a patch's horizon.
struct BaseCells {
    std::vector<Vec3f> axis;
    std::vector<float> radius;

    explicit BaseCells(const DirectionTiers& tiers) {
        for (std::uint32_t c = 0; c < tiers.baseCells(); ++c) {
            const SphericalTriangle t = cellTriangle(tiers.baseLevel(), c);
            const Vec3d center = cellCenter(tiers.baseLevel(), c);
            axis.emplace_back(center);
            const double least = std::min({center.dot(t.a), center.dot(t.b), center.dot(t.c)});
            radius.push_back(static_cast<float>(std::acos(least)));
        }
    }
};

/// Bakes items of one thread's voxels.
class ItemBaker {
public:
    ItemBaker(const Scene& scene, const DirectionTable& directions, const BaseCells& base,
              const BakeOptions& options, double spacing)
        : scene_(scene),
          directions_(directions),
          base_(base),
          options_(options),
          tiers_{options.level},
          spacing_(static_cast<float>(spacing)),
          baseCounts_(tiers_.baseCells()),
          fine_(tiers_.refinements() > 0 ? tiers_.baseCells() * kBlockCells : 0) {}

    void bakeItem(const Patch& patch, const Vec3i& voxel, std::uint64_t seed, CacheItems& out) {
        RayCounter rays(scene_, directions_, patch, seed);
        std::fill(baseCounts_.begin(), baseCounts_.end(), Count{});
        std::fill(fine_.begin(), fine_.end(), Count{});
        refined_.clear();
        findCells(patch);
        if (tiers_.refinements() == 0)
            for (const std::uint32_t c : cells_)
                rays.add(tiers_.baseLevel(), c, options_.rays, baseCounts_[c]);
        else
            traceFine(rays);
        rays.flush();
        traced_ += rays.raysTraced();
        store(patch, voxel, out);
    }

    std::uint64_t raysTraced() const { return traced_; }

private:
    using Block = std::array<Count, kBlockCells>;

    /// The base cells that are not wholly below the patch's horizon.
    void findCells(const Patch& patch) {
        const float spread = std::acos(std::clamp(patch.minAgreement, -1.0f, 1.0f));
        cells_.clear();
        for (std::uint32_t c = 0; c < tiers_.baseCells(); ++c) {
            const float angle =
                std::acos(std::clamp(base_.axis[c].dot(patch.normal), -1.0f, 1.0f));
            if (angle < static_cast<float>(kPi / 2) + spread + base_.radius[c]) cells_.push_back(c);
        }
    }

    Count* fineOf(std::uint32_t cell) { return &fine_[cell * kBlockCells]; }

    void addToFine(RayCounter& rays, std::uint32_t cell, int count) {
        for (std::uint32_t k = 0; k < kBlockCells; ++k)
            rays.add(tiers_.baseLevel() + 2, cell * kBlockCells + k, count, fineOf(cell)[k]);
    }

    Count sumFine(std::uint32_t cell) {
        Count sum;
        for (int k = 0; k < kBlockCells; ++k) sum += fineOf(cell)[k];
        return sum;
    }

    void traceFine(RayCounter& rays) {
        const bool adaptive = options_.adaptive;
        const bool deeper = tiers_.refinements() > 1;
        const int probe = std::min(kProbeRays, options_.rays);
        if (adaptive) {
            // One ray each; a patch no ray leaves needs no more.
            bool open = false;
            for (const std::uint32_t c : cells_) addToFine(rays, c, 1);
            rays.flush();
            for (const std::uint32_t c : cells_) open = open || sumFine(c).open > 0;
            if (open && probe > 1)
                for (const std::uint32_t c : cells_) addToFine(rays, c, probe - 1);
            rays.flush();
        }
        for (const std::uint32_t c : cells_) {
            if (adaptive && !sumFine(c).mixed()) continue;
            refined_.push_back({tiers_.blockKey(0, c), c, {}});
            if (!deeper || adaptive) addToFine(rays, c, adaptive ? options_.rays - probe : options_.rays);
        }
        rays.flush();
        if (deeper) traceFinest(rays);
    }

    void traceFinest(RayCounter& rays) {
        const std::size_t coarse = refined_.size();
        for (std::size_t i = 0; i < coarse; ++i)
            for (std::uint32_t k = 0; k < kBlockCells; ++k) {
                const std::uint32_t cell = refined_[i].cell * kBlockCells + k;
                Count& count = fine_[cell];
                if (options_.adaptive) {
                    if (!count.mixed()) continue;
                    const float nearest = rays.nearestOccluder(tiers_.baseLevel() + 2, cell, count);
                    if (nearest < kMinOccluderSpacings * spacing_) continue;
                }
                refined_.push_back({tiers_.blockKey(1, cell), cell, {}});
            }
        // Queued tallies stay where they are: nothing is added to refined_ from here on.
        for (std::size_t i = coarse; i < refined_.size(); ++i)
            for (std::uint32_t k = 0; k < kBlockCells; ++k)
                rays.add(tiers_.finest, refined_[i].cell * kBlockCells + k, finestRays(),
                         refined_[i].finest[k]);
        rays.flush();
        if (!options_.adaptive)
            for (std::size_t i = coarse; i < refined_.size(); ++i)
                for (const Count& count : refined_[i].finest) fine_[refined_[i].cell] += count;
    }

    void store(const Patch& patch, const Vec3i& voxel, CacheItems& out) {
        out.voxel.push_back(voxel);
        out.side.push_back(static_cast<std::uint8_t>(patch.side));
        out.normal.push_back(patch.normal);
        out.position.push_back(patch.meanPosition);
        for (std::uint32_t c = 0; c < tiers_.baseCells(); ++c) {
            Count sum = baseCounts_[c];
            if (tiers_.refinements() > 0) sum += sumFine(c);
            out.n.push_back(0);
            out.d.push_back(0);
            addCounts(out.n.back(), out.d.back(), sum.open, sum.rays);
        }
        for (const Refined& r : refined_) {
            const bool first = r.key < tiers_.blockKey(1, 0);
            const Count* counts = first ? fineOf(r.cell) : r.finest.data();
            CountBlock block{r.key, {}, {}};
            for (std::size_t k = 0; k < kBlockCells; ++k)
                addCounts(block.n[k], block.d[k], counts[k].open, counts[k].rays);
            out.blocks.push_back(block);
        }
        out.firstBlock.push_back(static_cast<std::uint32_t>(out.blocks.size()));
    }

    /// Neighbouring items are pooled, so that the finest regions need fewer rays of each.
    int finestRays() const {
        return options_.adaptive ? std::max(1, options_.rays / 4) : options_.rays;
    }

    struct Refined {
        std::uint16_t key;
        std::uint32_t cell;  ///< the refined one
        Block finest;        ///< second refinement only; the first is in fine_
    };

    const Scene& scene_;
    const DirectionTable& directions_;
    const BaseCells& base_;
    const BakeOptions& options_;
    DirectionTiers tiers_;
    float spacing_;
    std::vector<std::uint32_t> cells_;
    std::vector<Count> baseCounts_;
    std::vector<Count> fine_;
    std::vector<Refined> refined_;
    std::uint64_t traced_ = 0;
};

/// Ranges of fragments that share a voxel, of this shard.
std::vector<std::span<const Fragment>> splitByVoxel(std::span<const Fragment> fragments,
                                                    const BakeOptions& options) {
    std::vector<std::span<const Fragment>> voxels;
    for (std::size_t begin = 0; begin < fragments.size();) {
        std::size_t end = begin;
        while (end < fragments.size() && fragments[end].voxelKey == fragments[begin].voxelKey) ++end;
        if (mixBits(fragments[begin].voxelKey >> 9) % static_cast<std::uint64_t>(options.shards) ==
            static_cast<std::uint64_t>(options.shard))
            voxels.push_back(fragments.subspan(begin, end - begin));
        begin = end;
    }
    return voxels;
}

}  // namespace

void validate(const BakeOptions& options) {
    const auto refuse = [](const std::string& name, const auto& value, const std::string& wanted) {
        throw Error("--" + name + " " + std::to_string(value) + ": wanted " + wanted);
    };
    if (!(options.spacing >= 0) || std::isinf(options.spacing))
        refuse("spacing", options.spacing, "a length above 0");
    if (options.level < 0 || options.level > kMaxCacheLevel)
        refuse("level", options.level, "0 to " + std::to_string(kMaxCacheLevel));
    if (options.rays < 1 || options.rays > 255) refuse("rays", options.rays, "1 to 255");
    if (options.shards < 1 || options.shard < 0 || options.shard >= options.shards)
        throw Error("--shard " + std::to_string(options.shard + 1) + "/" +
                    std::to_string(options.shards) + ": wanted K/N with 1 <= K <= N");
}

double chooseSpacing(const TriangleMesh& mesh) {
    double surface = 0;
    Imath::Box3d box;
    for (const Vec3i& t : mesh.triangles) {
        const Vec3d a(mesh.positions[static_cast<std::size_t>(t.x)]);
        const Vec3d b(mesh.positions[static_cast<std::size_t>(t.y)]);
        const Vec3d c(mesh.positions[static_cast<std::size_t>(t.z)]);
        surface += (b - a).cross(c - a).length() / 2;
        box.extendBy(a);
        box.extendBy(b);
        box.extendBy(c);
    }
    constexpr double items = 40000;
    const double bySurface = std::sqrt(surface / items);
    const double byExtent = box.size().length() / 400;
    // Two digits are enough, and easier to write down.
    const double spacing = std::min(bySurface, byExtent);
    const double unit = std::pow(10, std::floor(std::log10(spacing)) - 1);
    return std::max(1.0, std::round(spacing / unit)) * unit;
}

BakeResult bake(const Scene& scene, const BakeOptions& options) {
    validate(options);
    BakeResult result;
    result.header.level = options.level;
    result.header.adaptive = options.adaptive;
    result.header.spacing = options.spacing > 0 ? options.spacing : chooseSpacing(scene.mesh());
    result.header.rays = options.rays;
    result.header.seeds = std::to_string(options.seed);
    result.header.version = kVersion;
    result.header.fingerprint = fingerprint(scene.mesh());

    const VoxelFrame frame(scene.mesh(), result.header.spacing);
    const std::vector<Fragment> fragments = placeFragments(scene.mesh(), frame);
    const auto voxels = splitByVoxel(fragments, options);
    const DirectionTable directions;
    const BaseCells base(result.header.tiers());

    constexpr std::size_t chunkSize = 32;
    std::vector<CacheItems> parts((voxels.size() + chunkSize - 1) / chunkSize);
    std::vector<std::uint64_t> rays(parts.size());
    Progress progress("bake", std::max<std::size_t>(1, voxels.size()));
    parallelFor(voxels.size(), chunkSize, [&](const Chunk& chunk) {
        throwIfInterrupted();
        ItemBaker baker(scene, directions, base, options, result.header.spacing);
        for (std::size_t v = chunk.begin; v < chunk.end; ++v) {
            const std::uint64_t key = voxels[v][0].voxelKey;
            for (const Patch& patch : makePatches(scene, frame, voxels[v], options.seed))
                baker.bakeItem(patch, frame.voxel(key),
                               hashWords(options.seed ^ 0x62616b65, key,
                                         static_cast<std::uint64_t>(patch.side)),
                               parts[chunk.index]);
        }
        rays[chunk.index] = baker.raysTraced();
        progress.add(chunk.end - chunk.begin);
    });
    for (std::size_t i = 0; i < parts.size(); ++i) {
        append(result.items, parts[i]);
        parts[i] = {};
        result.rays += rays[i];
    }
    return result;
}

}  // namespace shadowcache
