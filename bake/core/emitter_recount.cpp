#include "bake/core/emitter_recount.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

#include "bake/core/emitter_tracer.h"
#include "bake/core/patch.h"
#include "bake/core/placement.h"
#include "common/base/error.h"
#include "common/base/interrupt.h"
#include "common/base/parallel.h"
#include "common/base/progress.h"

namespace shadowcache {

namespace {

/// Voxels that a thread takes at a time.
constexpr std::size_t kVoxelsAtATime = 32;

/// Items of one voxel, by number.
struct ItemRange {
    std::size_t begin, end;
};

std::vector<ItemRange> itemsByVoxel(const CacheItems& items) {
    std::vector<ItemRange> voxels;
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (i == 0 || items.voxel[i] != items.voxel[i - 1]) voxels.push_back({i, i});
        voxels.back().end = i + 1;
    }
    return voxels;
}

/// Places the surface of some voxels.
std::vector<Fragment> placeVoxels(const TriangleMesh& mesh, const VoxelFrame& frame,
                                  const std::vector<Vec3i>& voxels) {
    VoxelKeys only;
    for (const Vec3i& voxel : voxels)
        if (frame.holds(voxel)) only.add(frame.key(voxel));
    return placeFragments(mesh, frame, &only);
}

/// Makes the patches of items again, and sends their rays to emitters.
class EmitterRecount {
public:
    EmitterRecount(const Scene& scene, const BakeOptions& options, const VoxelFrame& frame,
                   CacheItems& items)
        : scene_(scene),
          seed_(options.seed),
          frame_(frame),
          items_(items),
          fragments_(placeVoxels(scene.mesh(), frame, items.voxel)),
          emitters_(bakedEmitters(scene.mesh(), options)) {
        items.emitters.assign(items.size() * emitters_.size(), 0);
    }

    struct Done {
        std::size_t items = 0;
        std::uint64_t rays = 0;
    };

    /// Counts for the items of a voxel. Thread-safe for different voxels.
    Done count(const ItemRange& range) const {
        const Vec3i& voxel = items_.voxel[range.begin];
        Done done;
        if (!frame_.holds(voxel)) return done;
        SideSet sides;
        for (std::size_t i = range.begin; i < range.end; ++i)
            sides.set(static_cast<std::size_t>(PatchCode::of(items_.patch[i]).side));
        for (const Patch& patch :
             makePatches(scene_, frame_, fragmentsOf(frame_.key(voxel)), seed_, sides))
            countPatch(patch, frame_.center(voxel), range, done);
        return done;
    }

private:
    std::span<const Fragment> fragmentsOf(std::uint64_t key) const {
        const auto first = std::ranges::lower_bound(fragments_, key, {}, &Fragment::voxelKey);
        const auto last = std::ranges::upper_bound(fragments_, key, {}, &Fragment::voxelKey);
        return {first, last};
    }

    /// A patch is an item, or its subpatches are.
    void countPatch(const Patch& patch, const Vec3d& center, const ItemRange& range,
                    Done& done) const {
        for (std::size_t i = range.begin; i < range.end; ++i) {
            if (items_.patch[i] != patch.code.packed()) continue;
            std::vector<std::uint16_t> codes;
            done.rays += traceEmitters(scene_, emitters_, patch, codes);
            ++done.items;
            std::ranges::copy(
                codes, items_.emitters.begin() + static_cast<std::ptrdiff_t>(i * emitters_.size()));
            return;
        }
        for (const Patch& subpatch : makeSubpatches(scene_, center, frame_.spacing(), patch))
            countPatch(subpatch, center, range, done);
    }

    const Scene& scene_;
    const std::uint64_t seed_;
    const VoxelFrame& frame_;
    CacheItems& items_;
    const std::vector<Fragment> fragments_;
    const Emitters emitters_;
};

}  // namespace

std::uint64_t recountEmitters(const Scene& scene, const BakeOptions& options,
                              const VoxelFrame& frame, const std::filesystem::path& path,
                              CacheItems& items) {
    const std::vector<ItemRange> voxels = itemsByVoxel(items);
    Progress progress("emitters", std::max<std::size_t>(1, voxels.size()));
    const EmitterRecount recount(scene, options, frame, items);
    std::vector<std::uint64_t> rays(voxels.size());
    parallelFor(voxels.size(), kVoxelsAtATime, [&](const Chunk& chunk) {
        for (std::size_t v = chunk.begin; v < chunk.end; ++v) {
            throwIfInterrupted();
            const ItemRange& range = voxels[v];
            const EmitterRecount::Done done = recount.count(range);
            if (done.items != range.end - range.begin) {
                const Vec3i& at = items.voxel[range.begin];
                throwFileError(path,
                               fmt::format("voxel {}, {}, {}: {} items, of which the set has "
                                           "{}; expected those of a bake of it",
                                           at.x, at.y, at.z, range.end - range.begin, done.items));
            }
            rays[v] = done.rays;
        }
        progress.add(chunk.end - chunk.begin);
    });
    return std::accumulate(rays.begin(), rays.end(), std::uint64_t{0});
}

}  // namespace shadowcache
