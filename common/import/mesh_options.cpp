#include "common/import/mesh_options.h"

#include <fmt/core.h>

#include <cmath>

#include "common/base/error.h"
#include "common/base/option_checks.h"

namespace shadowcache {

std::optional<double> timeOf(std::optional<int> frame, double fps) {
    requireRange("fps", fps, 1e-3, 1e6);
    return frame ? std::optional(*frame / fps) : std::nullopt;
}

void requireScale(double scale) {
    if (scale > 0.0 && std::isfinite(scale)) return;
    throw Error(fmt::format("--scale {:g}: expected a number above 0", scale));
}

Affine worldOf(const MeshOptions& options) {
    const double s = options.scale;
    if (options.zUp) return {{Vec3d(s, 0, 0), Vec3d(0, 0, -s), Vec3d(0, s, 0)}, Vec3d(0.0)};
    return {{Vec3d(s, 0, 0), Vec3d(0, s, 0), Vec3d(0, 0, s)}, Vec3d(0.0)};
}

}  // namespace shadowcache
