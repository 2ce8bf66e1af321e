#include "bake/core/baker.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "bake/core/default_spacing.h"
#include "bake/core/emitter_tracer.h"
#include "bake/core/finished_items.h"
#include "bake/core/hit_tracer.h"
#include "bake/core/item_baker.h"
#include "bake/core/region_bytes.h"
#include "bake/core/side_choice.h"
#include "bake/core/subpatches.h"
#include "bake/core/surface_voxels.h"
#include "common/base/parallel.h"
#include "common/base/process.h"
#include "common/base/progress.h"
#include "common/base/version.h"
#include "common/emitters/emitters.h"
#include "common/mesh/mesh_fingerprint.h"
#include "common/random/salts.h"
#include "common/random/sequence.h"

namespace shadowcache {

namespace {

constexpr std::size_t kChunkSize = 32;

/// Runs of voxels of a sample, enough for a mean over places that differ a lot, and their chunks:
/// items of few voxels compress worse than those of many.
constexpr std::size_t kSampleRuns = 48, kRunChunks = 4;

std::size_t chunksOf(std::size_t count) {
    return (count + kChunkSize - 1) / kChunkSize;
}

/// Probe rays of what is baked and around it: by voxel, in the order of the voxel's patches.
using Probes = std::vector<std::vector<Probe>>;

std::uint64_t raysOf(const Probes& probes) {
    std::uint64_t rays = 0;
    for (const auto& voxel : probes)
        for (const Probe& probe : voxel) rays += probe.rays;
    return rays;
}

/// A bake in progress. An adaptive one takes two passes over the voxels: probe rays of all patches,
/// then the items, which get more rays where their own probes or their neighbours' are mixed. If
/// not everything is baked, a pass before them finds out what is wanted of each voxel.
class Bake {
public:
    Bake(const Scene& scene, const BakeOptions& options, double spacing,
         const VoxelSelection& selection, Checkpoint* checkpoint)
        : scene_(scene),
          options_(options),
          selection_(selection),
          checkpoint_(checkpoint),
          voxels_(scene.mesh(), spacing, options, selection),
          baker_(scene, options),
          emitters_(bakedEmitters(scene.mesh(), options)) {}

    Baked run() {
        chooseWanted();
        const std::size_t count = voxels_.wanted().size();
        Progress progress("bake", std::max<std::size_t>(1, count * (isAdaptive() ? 2 : 1)));
        Probes probes;
        if (isAdaptive()) probes = traceProbes(voxels_.withNeighbours(), count, progress);
        FinishedItems finished = bakeVoxels(voxels_.wanted(), probes, progress);
        const std::uint64_t probeRays = raysOf(probes);
        probes = {};
        Baked baked = finished.joined();
        baked.rays += probeRays;
        return baked;
    }

    void sample(BakeSample& out) {
        chooseWanted();
        const std::vector<std::size_t> chosen = sampleVoxels();
        out.voxels = chosen.size();
        out.ofVoxels = voxels_.wanted().size();
        Progress progress("estimate",
                          std::max<std::size_t>(1, chosen.size() * (isAdaptive() ? 2 : 1)));
        Probes probes;
        const double start = secondsNow();
        if (isAdaptive()) {
            const std::vector<std::size_t> needed = voxels_.withNeighbours(chosen);
            out.probes = needed.size();
            out.ofProbes = voxels_.withNeighbours().size();
            probes = traceProbes(needed, chosen.size(), progress);
        }
        out.probeRays = raysOf(probes);
        const double traced = secondsNow();
        Baked baked = bakeVoxels(chosen, probes, progress).joined();
        out.probeSeconds = traced - start;
        out.itemSeconds = secondsNow() - traced;
        out.itemRays = baked.rays;
        out.emitterRays = baked.emitterRays;
        out.items = std::move(baked.items);
    }

private:
    bool isAdaptive() const {
        return options_.adaptive && DirectionTiers{options_.level}.refinements() > 0;
    }

    void chooseWanted() {
        if (!selection_.everything())
            choice_ = chooseSides(scene_, voxels_, selection_, options_.seed);
    }

    /// A run from each stratum of the wanted voxels, in order.
    std::vector<std::size_t> sampleVoxels() const {
        const std::vector<std::size_t>& wanted = voxels_.wanted();
        constexpr std::size_t kRun = kRunChunks * kChunkSize;
        if (wanted.size() <= kSampleRuns * kRun) return wanted;
        const double last = static_cast<double>(wanted.size() - kRun);
        std::vector<std::size_t> chosen;
        for (std::size_t i = 0; i < kSampleRuns; ++i) {
            const double u = toUnit(hashWords(options_.seed, BakeSalt::sample, i));
            const auto first =
                static_cast<std::size_t>((static_cast<double>(i) + u) / kSampleRuns * last);
            for (std::size_t v = first; v < first + kRun; ++v)
                if (chosen.empty() || chosen.back() < wanted[v]) chosen.push_back(wanted[v]);
        }
        return chosen;
    }

    std::vector<Patch> patches(std::size_t v, const SideSet& sides) const {
        return makePatches(scene_, voxels_.frame(), voxels_.fragments(v), options_.seed, sides);
    }

    SideSet wantedSides(std::size_t v) const {
        return selection_.everything() ? SideSet().set() : choice_[v].sides;
    }

    /// Whether a wanted patch takes the probe of one with this normal into account (mixedAround).
    bool needsProbe(std::size_t v, const Vec3f& normal) const {
        if (selection_.everything()) return true;
        const auto isNear = [&](std::size_t other) {
            const ChosenSides& chosen = choice_[other];
            return std::ranges::any_of(chosen.outlines, [&](const Outline& patch) {
                return chosen.sides[static_cast<std::size_t>(patch.side)] &&
                       isAlike(normal, patch.normal);
            });
        };
        bool needed = isNear(v);
        voxels_.visitNeighbours(v, [&](std::size_t other) { needed = needed || isNear(other); });
        return needed;
    }

    /// A region of a pass, as the checkpoint has it or as `make` makes it.
    template <class Region, class Make>
    Region region(Checkpoint::Pass pass, std::size_t number, Region (*read)(std::string_view),
                  const Make& make) const {
        if (checkpoint_)
            if (const auto bytes = checkpoint_->read(pass, number)) return read(*bytes);
        Region made;
        make(made);
        if (checkpoint_) checkpoint_->add(pass, number, toBytes(made));
        return made;
    }

    /// First pass.
    ///
    /// @param count  voxels that are baked, as `progress` has them
    Probes traceProbes(const std::vector<std::size_t>& needed, std::size_t count,
                       Progress& progress) const {
        Probes probes(voxels_.size());
        parallelFor(needed.size(), kChunkSize, [&](const Chunk& chunk) {
            Probes made = region<Probes>(Checkpoint::Pass::probes, chunk.index, probesFromBytes,
                                         [&](Probes& out) {
                                             for (std::size_t i = chunk.begin; i < chunk.end; ++i)
                                                 out.push_back(traceProbes(needed[i]));
                                         });
            for (std::size_t i = chunk.begin; i < chunk.end; ++i)
                probes[needed[i]] = std::move(made[i - chunk.begin]);
            progress.add((chunk.end - chunk.begin) * count / needed.size());
        });
        return probes;
    }

    /// Probes of a voxel, in the order of its patches.
    std::vector<Probe> traceProbes(std::size_t v) const {
        throwIfInterrupted();
        if (!selection_.everything() && !choice_[v].outlines.empty()) return outlinedProbes(v);
        std::vector<Probe> probes;
        for (const Patch& patch : patches(v, SideSet().set()))
            probes.push_back(needsProbe(v, patch.normal) ? baker_.traceProbe(patch)
                                                         : Probe{patch.normal, patch.meanPosition});
        return probes;
    }

    /// The same where the outlines of the patches are known: only those that need probes are made.
    std::vector<Probe> outlinedProbes(std::size_t v) const {
        const std::vector<Outline>& outlines = choice_[v].outlines;
        std::vector<bool> needed;
        SideSet sides;
        for (const Outline& outline : outlines) {
            needed.push_back(needsProbe(v, outline.normal));
            if (needed.back()) sides.set(static_cast<std::size_t>(outline.side));
        }
        const std::vector<Patch> made = patches(v, sides);
        auto patch = made.begin();
        std::vector<Probe> probes;
        for (std::size_t k = 0; k < outlines.size(); ++k) {
            const bool isMade = sides[static_cast<std::size_t>(outlines[k].side)];
            probes.push_back(needed[k] ? baker_.traceProbe(*patch)
                                       : Probe{outlines[k].normal, outlines[k].position});
            if (isMade) ++patch;
        }
        return probes;
    }

    /// Second or only pass.
    FinishedItems bakeVoxels(const std::vector<std::size_t>& numbers, const Probes& probes,
                             Progress& progress) const {
        const std::size_t count = numbers.size();
        FinishedItems finished(chunksOf(count), checkpoint_);
        parallelFor(count, kChunkSize, [&](const Chunk& chunk) {
            finished.set(chunk.index,
                         region<Baked>(Checkpoint::Pass::items, chunk.index, bakedFromBytes,
                                       [&](Baked& out) {
                                           for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
                                               throwIfInterrupted();
                                               if (isAdaptive())
                                                   bakeAdaptively(numbers[i], probes, out);
                                               else
                                                   bakeUniformly(numbers[i], out);
                                           }
                                       }));
            progress.add(chunk.end - chunk.begin);
        });
        return finished;
    }

    void bakeUniformly(std::size_t v, Baked& out) const {
        for (const Patch& patch : patches(v, wantedSides(v)))
            add(baker_.countUniformly(patch), patch, v, out);
    }

    void bakeAdaptively(std::size_t v, const Probes& probes, Baked& out) const {
        std::size_t k = 0;
        for (const Patch& patch : patches(v, wantedSides(v))) {
            while (!isProbeOf(v, k, patch)) ++k;
            const Probe& probe = probes[v][k++];
            bakePatch(v, patch, probe, mixedAround(v, probe, probes), out);
        }
    }

    /// Whether probe `k` of a voxel is of the patch's side. Probes and patches are in the same
    /// order, so the first such one is the patch's.
    bool isProbeOf(std::size_t v, std::size_t k, const Patch& patch) const {
        return selection_.everything() || choice_[v].outlines[k].side == patch.code.side;
    }

    /// Bakes a patch as one item, or its subpatches if they see different amounts of sky.
    void bakePatch(std::size_t v, const Patch& patch, const Probe& probe, const CellSet& mixed,
                   Baked& out) const {
        const VoxelFrame& frame = voxels_.frame();
        std::vector<Patch> subpatches;
        if (mixed.any())
            subpatches =
                makeSubpatches(scene_, frame.center(voxels_.voxel(v)), frame.spacing(), patch);
        const Subdivision subdivision = baker_.traceProbes(std::move(subpatches));
        out.rays += subdivision.rays;
        if (!seeDifferentSky(subdivision, baker_.baseCells()))
            return add(baker_.refine(patch, probe, mixed, subdivision), patch, v, out);
        for (std::size_t k = 0; k < subdivision.patches.size(); ++k) {
            const Probe& own = subdivision.probes[k];
            bakePatch(v, subdivision.patches[k], own, mixed | own.mixed(), out);
        }
    }

    void add(const ItemCounts& counts, const Patch& patch, std::size_t v, Baked& out) const {
        const Vec3i voxel = voxels_.voxel(v);
        store(counts, patch, voxel, out.items);
        out.rays += counts.rays;
        if (options_.transport)
            out.rays += traceHits(scene_, voxels_.frame(), voxel, patch, out.items.hits);
        if (emitters_.empty()) return;
        const std::uint64_t traced = traceEmitters(scene_, emitters_, patch, out.items.emitters);
        out.rays += traced;
        out.emitterRays += traced;
    }

    /// Whether what one item's probe rays found may show in the other.
    static bool isAlike(const Vec3f& normal, const Vec3f& other) {
        return normal.dot(other) >= 0.5f;
    }

    /// Base cells in which the item or one next to it on the same side of a surface found both sky
    /// and occluders: a small opening that this item's probe rays missed, its neighbours' may have
    /// found. Of several depth layers next to it the nearest to its plane counts.
    CellSet mixedAround(std::size_t v, const Probe& probe, const Probes& probes) const {
        CellSet visible = probe.visible, occluded = probe.occluded;
        voxels_.visitNeighbours(v, [&](std::size_t other) {
            const Vec3f way(Vec3d(voxels_.voxel(other) - voxels_.voxel(v)));
            const auto distance = [&](const Probe& p) {
                return std::abs(probe.normal.dot(way + p.position - probe.position));
            };
            for (const Probe& p : probes[other]) {
                if (!isAlike(p.normal, probe.normal)) continue;
                if (std::any_of(probes[other].begin(), probes[other].end(), [&](const Probe& q) {
                        return areDepthLayers(p.normal, q.normal) && distance(q) < distance(p);
                    }))
                    continue;
                visible |= p.visible;
                occluded |= p.occluded;
            }
        });
        return visible & occluded;
    }

    const Scene& scene_;
    const BakeOptions& options_;
    const VoxelSelection& selection_;
    Checkpoint* checkpoint_;
    SurfaceVoxels voxels_;
    std::vector<ChosenSides> choice_;  ///< by voxel, if not everything is baked
    ItemBaker baker_;
    const Emitters emitters_;
};

}  // namespace

CacheHeader headerOf(const TriangleMesh& mesh, const BakeOptions& options) {
    CacheHeader header;
    header.level = options.level;
    header.adaptive = options.adaptive;
    header.spacing = options.spacing > 0 ? options.spacing
                                         : spacingFactor(options.quality) * chooseSpacing(mesh);
    header.bakes = {{.seed = options.seed,
                     .rays = options.rays,
                     .shards = options.shards,
                     .held = {{options.shard, options.shard}}}};
    header.version = kVersion;
    header.hits = options.transport ? kHitRays : 0;
    const Emitters emitters = bakedEmitters(mesh, options);
    for (std::size_t e = 0; e < emitters.size(); ++e)
        header.emitters.push_back(emitters.shapeOf(e));
    header.fingerprint = fingerprint(mesh);
    return header;
}

BakeResult bake(const Scene& scene, const BakeOptions& options, const VoxelSelection& selection,
                Checkpoint* checkpoint) {
    validate(options);
    BakeResult result;
    result.header = headerOf(scene.mesh(), options);
    Baked baked = Bake(scene, options, result.header.spacing, selection, checkpoint).run();
    result.items = std::move(baked.items);
    result.rays = baked.rays;
    result.emitterRays = baked.emitterRays;
    return result;
}

BakeSample sampleBake(const Scene& scene, const BakeOptions& options,
                      const VoxelSelection& selection) {
    validate(options);
    BakeSample sample;
    sample.header = headerOf(scene.mesh(), options);
    Bake(scene, options, sample.header.spacing, selection, nullptr).sample(sample);
    return sample;
}

}  // namespace shadowcache
