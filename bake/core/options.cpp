#include "bake/core/options.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>

#include "bake/core/placement.h"
#include "common/base/error.h"
#include "common/base/option_checks.h"
#include "common/base/tuned.h"
#include "common/cache/cache_items.h"
#include "common/mesh/placed_mesh.h"

namespace shadowcache {

namespace {

/// Items beyond which a bake with the default spacing would take more than a few minutes.
SHADOWCACHE_TUNED(double, kMostItems, 300000);

/// Patches of the surface that the default spacing aims at.
SHADOWCACHE_TUNED(double, kPatches, 40000);

/// Two digits are enough, and easier to write down.
double twoDigits(double x) {
    const double unit = std::pow(10, std::floor(std::log10(x)) - 1);
    return std::max(1.0, std::round(x / unit)) * unit;
}

/// Along the triangle's normal, as long as its area.
Vec3d areaVector(const std::array<Vec3d, 3>& corner) {
    return (corner[1] - corner[0]).cross(corner[2] - corner[0]) / 2;
}

/// Items of a bake: two sides for each axis that normals of a voxel's surface lean to.
std::size_t countItems(const TriangleMesh& mesh, double spacing) {
    std::size_t count = 0;
    std::uint64_t voxel = ~std::uint64_t{0};
    unsigned axes = 0;
    const auto endVoxel = [&] { count += 2 * static_cast<std::size_t>(std::popcount(axes)); };
    for (const Fragment& f : placeFragments(mesh, VoxelFrame(mesh, spacing))) {
        if (f.voxelKey != voxel) endVoxel(), axes = 0;
        voxel = f.voxelKey;
        const Vec3d normal = areaVector(placedCorners(mesh, f.triangle));
        int axis = 0;
        for (int k = 1; k < 3; ++k)
            if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
        axes |= 1u << axis;
    }
    endVoxel();
    return count;
}

}  // namespace

void validate(const BakeOptions& options) {
    requireRange("spacing", options.spacing, 0.0, 1e12);
    requireRange("level", options.level, 0, kMaxCacheLevel);
    requireRange("rays", options.rays, 1, 255);
    if (options.shards < 1 || options.shard < 0 || options.shard >= options.shards)
        throw Error("--shard " + std::to_string(options.shard + 1) + "/" +
                    std::to_string(options.shards) + ": expected K/N with 1 <= K <= N");
}

double chooseSpacing(const TriangleMesh& mesh) {
    double surface = 0;
    const std::size_t count = placedCount(mesh);
    for (std::size_t i = 0; i < count; ++i)
        surface += areaVector(placedCorners(mesh, static_cast<std::uint32_t>(i))).length();
    const double bySurface = std::sqrt(surface / kPatches);
    const double byExtent = placedBounds(mesh).size().length() / 400;
    double spacing = twoDigits(std::min(bySurface, byExtent));
    // Foliage and clutter have many more items than their extent suggests.
    for (;;) {
        const auto items = static_cast<double>(countItems(mesh, spacing));
        if (items <= kMostItems) return spacing;
        spacing = twoDigits(spacing * std::max(1.1, std::sqrt(items / kMostItems)));
    }
}

}  // namespace shadowcache
