#include "bake/options.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "bake/placement.h"
#include "common/cache_items.h"
#include "common/error.h"
#include "common/option_checks.h"

namespace shadowcache {

namespace {

/// Voxels beyond which a bake with the default spacing would take more than a few minutes.
constexpr double kMostVoxels = 120000;

/// Two digits are enough, and easier to write down.
double twoDigits(double x) {
    const double unit = std::pow(10, std::floor(std::log10(x)) - 1);
    return std::max(1.0, std::round(x / unit)) * unit;
}

std::size_t countVoxels(const TriangleMesh& mesh, double spacing) {
    std::size_t count = 0;
    std::uint64_t last = ~std::uint64_t{0};
    for (const Fragment& f : placeFragments(mesh, VoxelFrame(mesh, spacing))) {
        count += f.voxelKey != last;
        last = f.voxelKey;
    }
    return count;
}

}  // namespace

void validate(const BakeOptions& options) {
    requireRange("spacing", options.spacing, 0.0, 1e12);
    requireRange("level", options.level, 0, kMaxCacheLevel);
    requireRange("rays", options.rays, 1, 255);
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
    constexpr double kPatches = 40000;
    const double bySurface = std::sqrt(surface / kPatches);
    const double byExtent = box.size().length() / 400;
    double spacing = twoDigits(std::min(bySurface, byExtent));
    // Foliage and clutter fill many more voxels than their surface suggests.
    for (;;) {
        const auto voxels = static_cast<double>(countVoxels(mesh, spacing));
        if (voxels <= kMostVoxels) return spacing;
        spacing = twoDigits(spacing * std::max(1.1, std::sqrt(voxels / kMostVoxels)));
    }
}

}  // namespace shadowcache
