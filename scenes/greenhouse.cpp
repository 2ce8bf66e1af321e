#include <cmath>

#include "scenes/courtyard_parts.h"
#include "scenes/sets.h"

namespace shadowcache::scenes {
namespace {

constexpr double kHalf = 2, kEaves = 2.1, kRidge = 3.2, kLength = 6;  // m
constexpr int kBays = 8;

/// A bar of square section between two places.
void addBar(SetMesh& mesh, const Vec3d& from, const Vec3d& to) {
    Placement at;
    at.origin = from;
    at.z = (to - from).normalized();
    tangentFrame(at.z, at.x, at.y);
    addBox(mesh, at, {-0.025, -0.025, 0}, {0.025, 0.025, (to - from).length()},
           plain({0.7f, 0.72f, 0.7f}));
}

/// One pane between bars of neighbouring bays, and the bars.
void addGlazing(SetMesh& mesh) {
    const Paint glass = plain({0.93f, 0.97f, 0.95f}, Finish::pane);
    const Imath::V2d outline[] = {
        {-kHalf, 0}, {-kHalf, kEaves}, {0, kRidge}, {kHalf, kEaves}, {kHalf, 0}};
    const auto place = [&](int corner, int bay) {
        const Imath::V2d& p = outline[corner];
        return Vec3d(p.x, p.y, kLength * bay / kBays);
    };
    for (int corner = 0; corner < 5; ++corner) {
        for (int bay = 0; bay <= kBays; ++bay) {
            if (corner < 4) addBar(mesh, place(corner, bay), place(corner + 1, bay));
            if (bay < kBays) addBar(mesh, place(corner, bay), place(corner, bay + 1));
            if (corner < 4 && bay < kBays)
                addQuad(mesh,
                        {place(corner, bay), place(corner + 1, bay), place(corner + 1, bay + 1),
                         place(corner, bay + 1)},
                        glass);
        }
    }
    for (const double z : {0.0, kLength}) {
        addQuad(mesh,
                {Vec3d(-kHalf, 0, z), Vec3d(kHalf, 0, z), Vec3d(kHalf, kEaves, z),
                 Vec3d(-kHalf, kEaves, z)},
                glass);
        const int a = mesh.addVertex({-kHalf, kEaves, z}, glass({}));
        const int b = mesh.addVertex({kHalf, kEaves, z}, glass({}));
        const int c = mesh.addVertex({0, kRidge, z}, glass({}));
        mesh.addTriangle(a, b, c, Finish::pane);
        addBar(mesh, {-kHalf, kEaves, z}, {kHalf, kEaves, z});
    }
}

}  // namespace

SetMesh makeGreenhouse() {
    SetMesh mesh;
    addPatch(
        mesh, 16, 16, [](double u, double v) { return Vec3d(16 * v - 8, -0.01, 18 * u - 6); },
        weathered({0.2f, 0.17f, 0.1f}, 0.3, 0.7));
    addGlazing(mesh);
    for (const double x : {-1.35, 1.35}) {
        addBox(mesh, {}, {x - 0.5, 0.7, 0.3}, {x + 0.5, 0.78, kLength - 0.3},
               weathered(courtyard::kWood, 0.2, 0.4));
        for (const double z : {0.6, 2.9, 5.4})
            addBox(mesh, {}, {x - 0.45, 0, z - 0.05}, {x + 0.45, 0.7, z + 0.05},
                   weathered(courtyard::kWood, 0.2, 0.4));
    }
    courtyard::addHedge(mesh, moved({}, -1.35, 0.78, 3, kPi / 2), 2.4, 31);
    courtyard::addTree(mesh, moved({}, 0.1, 0, 5.2), 32);
    courtyard::addTree(mesh, moved({}, 3.4, 0, 2.5), 33);
    return mesh;
}

std::vector<CameraKey> greenhouseWalk() {
    return {{{0.1, 1.6, 0.5}, {0.2, 1.1, 5}}, {{-0.2, 1.6, 1.5}, {0.4, 1.1, 6}}};
}

}  // namespace shadowcache::scenes
