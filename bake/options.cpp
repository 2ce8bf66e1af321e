#include "bake/options.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "common/cache_items.h"
#include "common/error.h"
#include "common/option_checks.h"

namespace shadowcache {

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
    constexpr double kItems = 40000;
    const double bySurface = std::sqrt(surface / kItems);
    const double byExtent = box.size().length() / 400;
    // Two digits are enough, and easier to write down.
    const double spacing = std::min(bySurface, byExtent);
    const double unit = std::pow(10, std::floor(std::log10(spacing)) - 1);
    return std::max(1.0, std::round(spacing / unit)) * unit;
}

}  // namespace shadowcache
