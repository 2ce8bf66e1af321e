#include "common/import/mesh_options.h"

namespace shadowcache {

Affine worldOf(const MeshOptions& options) {
    const double s = options.scale;
    if (options.zUp) return {{Vec3d(s, 0, 0), Vec3d(0, 0, -s), Vec3d(0, s, 0)}, Vec3d(0.0)};
    return {{Vec3d(s, 0, 0), Vec3d(0, s, 0), Vec3d(0, 0, s)}, Vec3d(0.0)};
}

}  // namespace shadowcache
