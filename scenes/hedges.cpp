#include "scenes/courtyard_parts.h"
#include "scenes/sets.h"

namespace shadowcache::scenes {

SetMesh makeHedges() {
    SetMesh mesh;
    addPatch(
        mesh, 24, 24, [](double u, double v) { return Vec3d(24 * v - 12, 0, 24 * u - 12); },
        weathered({0.12f, 0.15f, 0.05f}, 0.4, 0.5));
    std::int64_t seed = 41;
    for (int row = 0; row < 3; ++row)
        for (const double x : {-1.3, 1.3})
            courtyard::addHedge(mesh, moved({}, x, 0, 2.6 * row - 2.6, kPi / 2), 2.4, seed++);
    for (const double x : {-2.4, 2.4})
        for (const double z : {-3.0, 0.0, 3.0})
            courtyard::addTree(mesh, moved({}, x, 0, z), seed++);
    courtyard::addBench(mesh, moved({}, 0, 0, -3.8));
    return mesh;
}

std::vector<CameraKey> hedgesWalk() {
    return {{{0.2, 1.4, 4.6}, {0, 0.7, -3}}, {{-0.1, 1.2, 2.8}, {0.2, 0.6, -4}}};
}

}  // namespace shadowcache::scenes
