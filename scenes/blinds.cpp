#include "scenes/courtyard_parts.h"
#include "scenes/sets.h"

namespace shadowcache::scenes {
namespace {

constexpr double kHalf = 2.5, kHeight = 2.8, kLength = 4.5;  // m: the room's width is twice kHalf
constexpr double kLeft = -1.3, kRight = 1.3, kLow = 0.9, kHigh = 2.3;  // the window's hole
constexpr int kSlats = 36;

void addShell(SetMesh& mesh) {
    const Paint plaster = plain({0.74f, 0.72f, 0.68f});
    const Placement room;
    const double wall = 0.2;
    addBox(mesh, room, {-kHalf - wall, -wall, -wall}, {kHalf + wall, 0, kLength + wall},
           weathered({0.3f, 0.19f, 0.1f}, 0.2, 0.3));
    addBox(mesh, room, {-kHalf - wall, kHeight, -wall},
           {kHalf + wall, kHeight + wall, kLength + wall}, plaster);
    for (const double s : {-1.0, 1.0})
        addBox(mesh, room, {s > 0 ? kHalf : -kHalf - wall, 0, -wall},
               {s > 0 ? kHalf + wall : -kHalf, kHeight, kLength + wall}, plaster);
    addBox(mesh, room, {-kHalf, 0, kLength}, {kHalf, kHeight, kLength + wall}, plaster);
    courtyard::addPiercedWall(mesh, room, {-kHalf, kHalf, 0, kHeight}, {kLeft, kRight, kLow, kHigh},
                              -wall, 0, plaster);
}

/// Slats that are a little wider than their distance, tilted so that the sky shows between them.
void addSlats(SetMesh& mesh) {
    const Paint white = plain({0.8f, 0.79f, 0.76f});
    const double pitch = (kHigh - kLow) / kSlats, tilt = 0.6;
    for (int i = 0; i < kSlats; ++i) {
        const Placement slat{{0, kLow + (i + 0.5) * pitch, -0.1},
                             {1, 0, 0},
                             {0, std::cos(tilt), -std::sin(tilt)},
                             {0, std::sin(tilt), std::cos(tilt)}};
        addBox(mesh, slat, {kLeft, -0.0008, -0.6 * pitch}, {kRight, 0.0008, 0.6 * pitch}, white);
    }
}

}  // namespace

SetMesh makeBlinds() {
    SetMesh mesh;
    addShell(mesh);
    addSlats(mesh);
    courtyard::addBench(mesh, moved({}, -1.1, 0, 1.6, 0.4));
    courtyard::addTree(mesh, moved({}, 1.7, 0, 3.6), 21);
    addBox(mesh, moved({}, 0.9, 0, 1.7, -0.5), {-0.3, 0, -0.3}, {0.3, 0.6, 0.3},
           plain({0.16f, 0.28f, 0.42f}));
    return mesh;
}

std::vector<CameraKey> blindsWalk() {
    return {{{1.6, 1.6, 4.2}, {-0.6, 1.2, 0.4}}, {{0.4, 1.5, 4.2}, {-0.8, 1.1, 0.4}}};
}

}  // namespace shadowcache::scenes
