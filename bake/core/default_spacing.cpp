#include "bake/core/default_spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "bake/core/least_spacing.h"
#include "bake/core/repeated_triangles.h"
#include "bake/core/surface_count.h"
#include "common/base/tuned.h"
#include "common/mesh/placed_mesh.h"

namespace shadowcache {

namespace {

/// Items beyond which a bake with the default spacing would take more than a few minutes.
SHADOWCACHE_TUNED(double, kMostItems, 300000);

/// Items of a voxel above which a set is clutter, as foliage. There rays disagree by where they
/// start more than by direction, at any spacing: it is made coarser in proportion.
SHADOWCACHE_TUNED(double, kClutter, 3.2);

/// Patches of the surface that the default spacing aims at.
constexpr double kPatches = 40000;

/// Two digits are enough, and easier to write down.
double twoDigits(double x) {
    const double unit = std::pow(10, std::floor(std::log10(x)) - 1);
    return std::max(1.0, std::round(x / unit)) * unit;
}

/// Along the triangle's normal, as long as its area.
Vec3d areaVector(const std::array<Vec3d, 3>& corner) {
    return (corner[1] - corner[0]).cross(corner[2] - corner[0]) / 2;
}

}  // namespace

double rayFactor(BakeQuality quality) {
    constexpr double kStep = 8;
    return std::pow(kStep, static_cast<int>(quality) - static_cast<int>(BakeQuality::good));
}

double spacingFactor(BakeQuality quality) {
    return 1 / std::sqrt(rayFactor(quality));
}

double chooseSpacing(const TriangleMesh& mesh, SurfaceCount* count) {
    double surface = 0;
    const std::size_t triangles = placedCount(mesh);
    const std::vector<bool> repeated = repeatedTriangles(mesh);
    for (std::size_t i = 0; i < triangles; ++i) {
        if (i < repeated.size() && repeated[i]) continue;
        surface += areaVector(placedCorners(mesh, static_cast<std::uint32_t>(i))).length();
    }
    const double bySurface = std::sqrt(surface / kPatches);
    const double byExtent = placedBounds(mesh).size().length() / 400;
    // A set far from the origin, or of small things far apart, allows no finer one than this.
    const double least = twoDigits(1.1 * leastSpacing(mesh));
    double spacing = std::max(least, twoDigits(std::min(bySurface, byExtent)));
    // Foliage and clutter have many more items than their extent suggests.
    for (;;) {
        const SurfaceCount counted = countSurface(mesh, VoxelFrame(mesh, spacing));
        if (count) *count = counted;
        const auto items = static_cast<double>(counted.items);
        const double ofVoxel = items / std::max(1.0, static_cast<double>(counted.voxels));
        const double clutter = std::max(1.0, ofVoxel / kClutter);
        // Items are in inverse proportion to the square of the spacing.
        const double load = items * clutter * clutter;
        if (load <= kMostItems) return spacing;
        spacing = twoDigits(spacing * std::max(1.1, std::sqrt(load / kMostItems)));
    }
}

}  // namespace shadowcache
