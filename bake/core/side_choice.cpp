#include "bake/core/side_choice.h"

#include <algorithm>
#include <array>
#include <atomic>

#include "common/base/parallel.h"
#include "common/base/progress.h"
#include "common/cache/lookup_weight.h"

namespace shadowcache {

namespace {

constexpr std::size_t kVoxelsPerChunk = 32;
constexpr std::size_t kPlacesPerChunk = 4096;

/// A side is wanted if one of its patches would have this share of the least weight that an item
/// is used with: patches that are cut can weigh more than whole.
constexpr float kShareOfLeast = 0.25f;

using Bits = std::uint8_t;

class SideChooser {
public:
    SideChooser(const Scene& scene, const SurfaceVoxels& voxels, const VoxelSelection& selection,
                std::uint64_t seed)
        : scene_(scene),
          voxels_(voxels),
          selection_(selection),
          seed_(seed),
          chosen_(voxels.size()),
          wanted_(voxels.size(), 0) {}

    std::vector<ChosenSides> choose() {
        makeOutlines();
        if (selection_.lookups) {
            lookUpAll();
            if (selection_.margin > 0) addMargin();
        }
        for (const std::size_t v : voxels_.wanted())
            for (const Outline& patch : chosen_[v].outlines) {
                if (selection_.lookups && (wanted_[v] >> patch.side & 1) == 0) continue;
                if (selection_.present.contains(voxels_.key(v), patch.side)) continue;
                chosen_[v].sides.set(static_cast<std::size_t>(patch.side));
            }
        return std::move(chosen_);
    }

private:
    /// A patch near a place, and its weight there.
    struct Near {
        std::size_t voxel;
        int side;
        float weight;
    };

    void makeOutlines() {
        const std::vector<std::size_t>& candidates = voxels_.candidates();
        parallelFor(candidates.size(), kVoxelsPerChunk, [&](const Chunk& chunk) {
            throwIfInterrupted();
            for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
                const std::size_t v = candidates[i];
                for (const Patch& patch :
                     makePatches(scene_, voxels_.frame(), voxels_.fragments(v), seed_))
                    chosen_[v].outlines.push_back(
                        {patch.code.side, patch.normal, patch.meanPosition});
            }
        });
    }

    void lookUpAll() {
        const auto& places = selection_.lookups->places();
        parallelFor(places.size(), kPlacesPerChunk, [&](const Chunk& chunk) {
            throwIfInterrupted();
            std::array<std::size_t, 8> around{};
            std::vector<Near> near;
            for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
                if (i == chunk.begin || places[i].voxelKey != places[i - 1].voxelKey)
                    around = voxelsAround(places[i].voxelKey);
                lookUp(places[i], around, near);
            }
        });
    }

    std::array<std::size_t, 8> voxelsAround(std::uint64_t key) const {
        const Vec3i low = voxels_.frame().voxel(key);
        std::array<std::size_t, 8> around{};
        for (int k = 0; k < 8; ++k)
            around[static_cast<std::size_t>(k)] =
                voxels_.find(low + Vec3i(k & 1, k >> 1 & 1, k >> 2));
        return around;
    }

    /// Marks the sides that have a share in a lookup.
    void lookUp(const LookupPlaces::Place& place, const std::array<std::size_t, 8>& around,
                std::vector<Near>& near) {
        const Vec3f f = place.position(), normal = place.normal();
        near.clear();
        float sum = 0;
        for (int k = 0; k < 8; ++k) {
            const std::size_t v = around[static_cast<std::size_t>(k)];
            if (v == voxels_.size()) continue;
            const Vec3i step(k & 1, k >> 1 & 1, k >> 2);
            double trilinear = 1;
            for (int axis = 0; axis < 3; ++axis)
                trilinear *= static_cast<double>(step[axis] ? f[axis] : 1 - f[axis]);
            for (const Outline& patch : chosen_[v].outlines) {
                const float agreement = agreementOf(patch.normal, normal);
                if (agreement <= 0) continue;
                const float weight = itemWeight(nearOf(trilinear), agreement,
                                                patch.position - (f - Vec3f(step)), normal);
                near.push_back({v, patch.side, weight});
                sum += weight;
            }
        }
        for (const Near& patch : near)
            if (patch.weight >= kShareOfLeast * kLeastItemShare * sum)
                std::atomic_ref(wanted_[patch.voxel])
                    .fetch_or(static_cast<Bits>(1u << patch.side), std::memory_order_relaxed);
    }

    /// Sides of voxels near wanted ones that look the same way.
    void addMargin() {
        const std::vector<Bits> seen = wanted_;
        const std::vector<std::size_t>& candidates = voxels_.candidates();
        parallelFor(candidates.size(), kVoxelsPerChunk, [&](const Chunk& chunk) {
            throwIfInterrupted();
            for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
                const std::size_t v = candidates[i];
                Bits all = 0;
                for (const Outline& patch : chosen_[v].outlines)
                    all |= static_cast<Bits>(1u << patch.side);
                voxels_.searchAround(v, selection_.margin, [&](std::size_t other) {
                    for (const Outline& from : chosen_[other].outlines) {
                        if ((seen[other] >> from.side & 1) == 0) continue;
                        for (const Outline& patch : chosen_[v].outlines)
                            if (agreementOf(patch.normal, from.normal) > 0)
                                wanted_[v] |= static_cast<Bits>(1u << patch.side);
                    }
                    return (wanted_[v] & all) == all;
                });
            }
        });
    }

    const Scene& scene_;
    const SurfaceVoxels& voxels_;
    const VoxelSelection& selection_;
    const std::uint64_t seed_;
    std::vector<ChosenSides> chosen_;  ///< by voxel
    std::vector<Bits> wanted_;         ///< by voxel: sides of lookups
};

}  // namespace

std::vector<ChosenSides> chooseSides(const Scene& scene, const SurfaceVoxels& voxels,
                                     const VoxelSelection& selection, std::uint64_t seed) {
    return SideChooser(scene, voxels, selection, seed).choose();
}

}  // namespace shadowcache
