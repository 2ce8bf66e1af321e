#include "scenes/courtyard_parts.h"
#include "scenes/sets.h"

namespace shadowcache::scenes {

using courtyard::Facing;
using courtyard::Side;

SetMesh makeCourtyard() {
    SetMesh mesh;
    for (const Side& side : courtyard::sides()) {
        courtyard::addGroundArcade(mesh, side);
        if (side.facing == Facing::east) {
            courtyard::addTerrace(mesh, side);
            continue;
        }
        courtyard::addGallery(mesh, side);
        courtyard::addRoof(mesh, side);
    }
    courtyard::addCorners(mesh);
    courtyard::addTower(mesh);
    courtyard::addPavement(mesh);
    courtyard::addFountain(mesh);
    courtyard::addStair(mesh);
    courtyard::addRoom(mesh);

    std::int64_t seed = 1;
    courtyard::addTree(mesh, moved({}, -5.4, 0, -2.9, 0.3), seed++);
    courtyard::addTree(mesh, moved({}, -5.6, 0, 4.6, 1.3), seed++);
    courtyard::addTree(mesh, moved({}, 5.4, 0, -2.9, 2.3), seed++);
    courtyard::addTree(mesh, moved({}, 7.8, 0, 0.0, 3.3), seed++);
    courtyard::addTree(mesh, moved({}, -7.75, 0, 3.0), 11);
    courtyard::addTree(mesh, moved({}, -7.75, 0, 0.0), 12);
    courtyard::addTree(mesh, moved({}, -4.2, 0, -4.75), 13);
    for (const double x : {-3.2, 3.2}) courtyard::addHedge(mesh, moved({}, x, 0, 2.9), 2.4, seed++);
    for (const double x : {-3.2, 3.2})
        courtyard::addHedge(mesh, moved({}, x, 0, -2.9), 2.4, seed++);
    courtyard::addBench(mesh, moved({}, -3.2, 0, 2.25));
    courtyard::addBench(mesh, moved({}, 3.2, 0, -2.25));
    for (const double x : {-3.0, 3.0}) courtyard::addBench(mesh, moved({}, x, 0.3, 8.9));
    return mesh;
}

SetMesh makeNight() {
    SetMesh mesh = makeCourtyard();
    courtyard::addLights(mesh);
    return mesh;
}

std::vector<CameraKey> nightWalk() {
    return {{{-9.6, 1.9, -2.4}, {-13.2, 1.3, 0.9}}, {{-9.9, 1.85, -1.6}, {-13.4, 1.25, 0.6}}};
}

std::vector<CameraKey> courtyardWalk() {
    return {{{8.45, 1.95, 5.15}, {-2.6, 2.95, -0.9}}, {{6.6, 1.95, 5.05}, {-4.0, 2.9, -0.6}},
            {{4.4, 1.95, 4.95}, {-6.0, 2.8, -0.2}},   {{2.0, 1.9, 4.75}, {-8.0, 2.6, 0.4}},
            {{-0.5, 1.8, 4.2}, {-9.0, 2.3, 1.0}},     {{-2.9, 1.7, 3.2}, {-10.0, 1.85, 1.3}}};
}

}  // namespace shadowcache::scenes
