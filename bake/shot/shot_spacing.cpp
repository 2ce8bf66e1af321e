#include "bake/shot/shot_spacing.h"

#include <cmath>
#include <unordered_set>
#include <utility>
#include <vector>

#include "bake/core/default_spacing.h"
#include "bake/core/voxel_frame.h"
#include "common/base/tuned.h"
#include "common/cache/cache_items.h"

namespace shadowcache {

namespace {

/// Rays of a bake that a pixel is worth, at 64 samples and four bounces.
SHADOWCACHE_TUNED(double, kRaysOfPixel, 250);
/// Rays of a bake of the finest level for each side of a voxel that lookups see.
SHADOWCACHE_TUNED(double, kRaysOfSide, 20000);
/// The same of the level below, which has a quarter of the regions.
const double kRaysOfCoarseSide = kRaysOfSide / 4;
/// From this factor on, finer voxels of the level below tell more than the finest level.
SHADOWCACHE_TUNED(double, kCoarseFactor, 2);
constexpr double kMostFactor = 16;
const double kStep = std::sqrt(2.0);

/// Where a lookup is, in world units.
Vec3d positionOf(const LookupPlaces::Place& place, const VoxelFrame& frame) {
    return (Vec3d(frame.voxel(place.voxelKey)) + Vec3d(place.position())) * frame.spacing();
}

/// Side of a voxel that a normal leans to most.
std::uint64_t sideOf(const Vec3f& normal) {
    int axis = 0;
    for (int k = 1; k < 3; ++k)
        if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
    const int side = 2 * axis + (normal[axis] < 0 ? 1 : 0);
    return static_cast<std::uint64_t>(side);
}

/// Number of the sides of voxels that lookups see if voxels are `factor` times as wide.
std::size_t countSides(const LookupPlaces& places, const VoxelFrame& frame, double factor) {
    std::unordered_set<std::uint64_t> sides;
    std::uint64_t last = 0;
    const double spacing = factor * frame.spacing();
    for (const LookupPlaces::Place& place : places.places()) {
        const Vec3d p = positionOf(place, frame) / spacing;
        std::uint64_t key = sideOf(place.normal());
        for (int k = 0; k < 3; ++k)
            key = key << 20 | (static_cast<std::uint64_t>(std::llround(p[k])) & 0xfffff);
        // Places are in the order of their voxels, so that most repeat the one before.
        if (key != last) sides.insert(key);
        last = key;
    }
    return sides.size();
}

}  // namespace

LookupPlaces inVoxelsOf(const VoxelFrame& coarser, const LookupPlaces& places,
                        const VoxelFrame& frame) {
    std::vector<LookupPlaces::Place> moved;
    for (const LookupPlaces::Place& place : places.places()) {
        const Vec3d p = positionOf(place, frame) / coarser.spacing();
        const Vec3d low(std::floor(p.x), std::floor(p.y), std::floor(p.z));
        const Vec3i voxel(low);
        if (coarser.holds(voxel))
            moved.push_back(
                LookupPlaces::makePlace(coarser.key(voxel), Vec3f(p - low), place.normal()));
    }
    LookupPlaces out;
    out.add(std::move(moved));
    return out;
}

ShotResolution resolutionOfShot(const LookupPlaces& places, const VoxelFrame& frame, double pixels,
                                std::optional<int> level) {
    const auto isWorth = [&](double factor, double raysOfSide) {
        const auto sides = static_cast<double>(countSides(places, frame, factor));
        return raysOfSide * sides <= kRaysOfPixel * pixels;
    };
    const auto factorFor = [&](double raysOfSide) {
        double factor = 1;
        while (factor < kMostFactor && !isWorth(factor, raysOfSide)) factor *= kStep;
        return factor;
    };
    if (level)
        return {factorFor(*level == kMaxCacheLevel ? kRaysOfSide : kRaysOfCoarseSide), *level};
    const double factor = factorFor(kRaysOfSide);
    if (factor <= kCoarseFactor) return {factor, kMaxCacheLevel};
    return {factorFor(kRaysOfCoarseSide), kMaxCacheLevel - 1};
}

bool fitToShot(const TriangleMesh& mesh, double pixels, bool isLevelGiven, BakeOptions& options,
               VoxelFrame& frame, LookupPlaces& places) {
    const ShotResolution found =
        resolutionOfShot(places, frame, rayFactor(options.quality) * pixels,
                         isLevelGiven ? std::optional(options.level) : std::nullopt);
    options.level = found.level;
    if (found.factor == 1) return false;
    options.spacing *= found.factor;
    const VoxelFrame finest = std::exchange(frame, VoxelFrame(mesh, options.spacing));
    places = inVoxelsOf(frame, places, finest);
    return true;
}

}  // namespace shadowcache
