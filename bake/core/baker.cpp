#include "bake/core/baker.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <string>

#include "bake/core/item_baker.h"
#include "bake/core/subpatches.h"
#include "common/base/parallel.h"
#include "common/base/progress.h"
#include "common/base/sequence.h"
#include "common/base/version.h"
#include "common/mesh/mesh_fingerprint.h"

namespace shadowcache {

namespace {

/// The voxels of a set that hold surface, and the part of them that this bake is to do.
struct Voxels {
    std::vector<std::span<const Fragment>> all;  ///< in the order of their keys
    std::size_t begin = 0, end = 0;              ///< this shard's
};

Voxels splitByVoxel(std::span<const Fragment> fragments, const BakeOptions& options) {
    Voxels voxels;
    for (std::size_t begin = 0; begin < fragments.size();) {
        std::size_t end = begin;
        while (end < fragments.size() && fragments[end].voxelKey == fragments[begin].voxelKey)
            ++end;
        voxels.all.push_back(fragments.subspan(begin, end - begin));
        begin = end;
    }
    const auto share = [&](int k) {
        return voxels.all.size() * static_cast<std::size_t>(k) /
               static_cast<std::size_t>(options.shards);
    };
    voxels.begin = share(options.shard);
    voxels.end = share(options.shard + 1);
    return voxels;
}

constexpr std::size_t kChunkSize = 32;

/// A bake under way.
class Bake {
public:
    Bake(const Scene& scene, const BakeOptions& options, const CacheHeader& header)
        : scene_(scene),
          options_(options),
          frame_(scene.mesh(), header.spacing),
          fragments_(placeFragments(scene.mesh(), frame_)),
          voxels_(splitByVoxel(fragments_, options)),
          base_(header.tiers()),
          probes_(voxels_.all.size()) {}

    void run(BakeResult& result) {
        const std::size_t count = voxels_.end - voxels_.begin;
        const bool probing = options_.adaptive && result.header.tiers().refinements() > 0;
        Progress progress("bake", std::max<std::size_t>(1, count * (probing ? 2 : 1)));
        if (probing) {
            const std::vector<std::size_t> needed = withNeighbours();
            result.rays += forAll(
                needed.size(),
                [&](ItemBaker& baker, std::size_t i, std::size_t) {
                    const std::size_t v = needed[i];
                    for (const Patch& patch : patches(v)) probes_[v].push_back(baker.probe(patch));
                },
                [&](std::size_t done) {
                    progress.add(done * count / std::max<std::size_t>(1, needed.size()));
                });
        }
        std::vector<CacheItems> parts((count + kChunkSize - 1) / kChunkSize);
        result.rays += forAll(
            count,
            [&](ItemBaker& baker, std::size_t i, std::size_t chunk) {
                const std::size_t v = voxels_.begin + i;
                const std::vector<Patch> sides = patches(v);
                for (std::size_t k = 0; k < sides.size(); ++k) {
                    if (probing)
                        finish(baker, v, sides[k], probes_[v][k], mixedAround(v, probes_[v][k]),
                               parts[chunk]);
                    else
                        baker.finish(sides[k], voxel(v), {}, {}, false, parts[chunk]);
                }
            },
            [&](std::size_t done) { progress.add(done); });
        for (CacheItems& part : parts) {
            append(result.items, part);
            part = {};
        }
    }

private:
    Vec3i voxel(std::size_t v) const { return frame_.voxel(voxels_.all[v][0].voxelKey); }

    std::vector<Patch> patches(std::size_t v) const {
        return makePatches(scene_, frame_, voxels_.all[v], options_.seed);
    }

    /// Finishes a patch, or its subpatches where they see different things.
    void finish(ItemBaker& baker, std::size_t v, const Patch& patch, const Probe& probe,
                const std::bitset<Probe::kCells>& mixed, CacheItems& out) {
        std::vector<Patch> subpatches;
        if (mixed.any())
            subpatches = makeSubpatches(scene_, frame_.center(voxel(v)), frame_.spacing(), patch);
        const std::vector<Probe> probes = baker.probeSubpatches(subpatches);
        if (!seeDifferentSky(subpatches, probes, base_)) {
            baker.finish(patch, voxel(v), probe, mixed, areAlikeInSize(subpatches), out);
            return;
        }
        for (std::size_t k = 0; k < subpatches.size(); ++k)
            finish(baker, v, subpatches[k], probes[k], mixed | (probes[k].open & probes[k].blocked),
                   out);
    }

    /// Runs `body(baker, index, chunk)` over [0, count) in parallel.
    ///
    /// @return rays traced
    template <class Body, class Done>
    std::uint64_t forAll(std::size_t count, const Body& body, const Done& done) {
        std::vector<std::uint64_t> rays((count + kChunkSize - 1) / kChunkSize);
        parallelFor(count, kChunkSize, [&](const Chunk& chunk) {
            ItemBaker baker(scene_, directions_, base_, options_, frame_.spacing());
            for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
                throwIfInterrupted();
                body(baker, i, chunk.index);
            }
            rays[chunk.index] = baker.raysTraced();
            done(chunk.end - chunk.begin);
        });
        return std::accumulate(rays.begin(), rays.end(), std::uint64_t{0});
    }

    /// Calls `visit` with the index of each voxel of the 26 around `v` that holds surface.
    template <class Visit>
    void visitNeighbours(std::size_t v, const Visit& visit) const {
        const Vec3i center = voxel(v);
        for (int k = 0; k < 27; ++k) {
            if (k == 13) continue;
            const std::uint64_t key =
                frame_.key(center + Vec3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
            const auto found = std::lower_bound(voxels_.all.begin(), voxels_.all.end(), key,
                                                [](const auto& fragments, std::uint64_t wanted) {
                                                    return fragments[0].voxelKey < wanted;
                                                });
            if (found != voxels_.all.end() && (*found)[0].voxelKey == key)
                visit(static_cast<std::size_t>(found - voxels_.all.begin()));
        }
    }

    /// This shard's voxels and all around them, whose probes tell where to look closer.
    std::vector<std::size_t> withNeighbours() const {
        std::vector<std::uint8_t> needed(voxels_.all.size(), 0);
        std::fill(needed.begin() + static_cast<std::ptrdiff_t>(voxels_.begin),
                  needed.begin() + static_cast<std::ptrdiff_t>(voxels_.end), std::uint8_t{1});
        if (options_.shards > 1)
            for (std::size_t v = voxels_.begin; v < voxels_.end; ++v)
                visitNeighbours(v, [&](std::size_t other) { needed[other] = 1; });
        std::vector<std::size_t> list;
        for (std::size_t v = 0; v < needed.size(); ++v)
            if (needed[v]) list.push_back(v);
        return list;
    }

    /// Base cells in which the item or one next to it on the same side of a surface found both sky
    /// and occluders: a small opening that this item's first rays missed, its neighbours' may have
    /// met. Of several layers next to it the nearest to its plane counts.
    std::bitset<Probe::kCells> mixedAround(std::size_t v, const Probe& probe) const {
        auto open = probe.open, blocked = probe.blocked;
        const auto add = [&](std::size_t other) {
            const Vec3f way(Vec3d(voxel(other) - voxel(v)));
            const auto distance = [&](const Probe& p) {
                return std::abs(probe.normal.dot(way + p.position - probe.position));
            };
            for (const Probe& p : probes_[other]) {
                if (p.normal.dot(probe.normal) < 0.5f) continue;
                if (std::any_of(probes_[other].begin(), probes_[other].end(), [&](const Probe& q) {
                        return areDepthLayers(p.normal, q.normal) && distance(q) < distance(p);
                    }))
                    continue;
                open |= p.open;
                blocked |= p.blocked;
            }
        };
        visitNeighbours(v, add);
        return open & blocked;
    }

    const Scene& scene_;
    const BakeOptions& options_;
    VoxelFrame frame_;
    std::vector<Fragment> fragments_;
    Voxels voxels_;
    DirectionTable directions_;
    BaseCells base_;
    std::vector<std::vector<Probe>> probes_;  ///< by voxel, in the order of its patches
};

}  // namespace

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

    Bake(scene, options, result.header).run(result);
    return result;
}

}  // namespace shadowcache
