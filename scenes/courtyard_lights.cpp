#include "scenes/courtyard_parts.h"

namespace shadowcache::scenes::courtyard {
namespace {

/// A globe of milky glass on a rod that ends in the vault above it.
void addLantern(SetMesh& mesh, const Placement& at) {
    const Imath::V2d globe[] = {{0, -0.13},     {0.065, -0.113}, {0.113, -0.065}, {0.13, 0},
                                {0.113, 0.065}, {0.065, 0.113},  {0, 0.13}};
    addLathe(mesh, at, globe, 14, plain({0.8f, 0.8f, 0.8f}, Finish::lantern));
    const Imath::V2d cap[] = {
        {0.09, 0.105}, {0.095, 0.125}, {0.03, 0.16}, {0.012, 0.2}, {0.012, 1.6}};
    addLathe(mesh, at, cap, 12, plain(kBronze, Finish::bronze));
}

/// A shade on a cord, open below; its socket closes it above.
void addTableLamp(SetMesh& mesh, const Placement& at, double ceiling) {
    const Imath::V2d shade[] = {{0.27, -0.12}, {0.24, -0.03}, {0.15, 0.07}, {0.06, 0.12}};
    addLathe(mesh, at, shade, 28, plain({0.74f, 0.66f, 0.52f}));
    const Imath::V2d cord[] = {
        {0, 0.1}, {0.062, 0.1}, {0.05, 0.16}, {0.006, 0.18}, {0.006, ceiling}};
    addLathe(mesh, at, cord, 12, plain({0.1f, 0.08f, 0.06f}));
    mesh.lamps.push_back({"lamp over the table", at(0, 0, 0), {1.0f, 0.72f, 0.44f}, 14, 0.045});
}

void addPane(SetMesh& mesh, const Placement& bay) {
    constexpr double kMiddle = 0.085;  // of the window's bars
    addQuad(mesh,
            {bay(kWindow.x0, kWindow.y0, kMiddle), bay(kWindow.x1, kWindow.y0, kMiddle),
             bay(kWindow.x1, kWindow.y1, kMiddle), bay(kWindow.x0, kWindow.y1, kMiddle)},
            plain({0.94f, 0.98f, 0.96f}, Finish::pane));
}

}  // namespace

void addLights(SetMesh& mesh) {
    for (const Side& side : sides())
        for (int bay = 0; bay < side.bays; bay += 2)
            if (!side.isRoom(bay))
                addLantern(mesh, moved(side.at, side.bayCenter(bay), 2.7, kDepth / 2));
    const Placement west = sides()[static_cast<std::size_t>(Facing::west)].at;
    addTableLamp(mesh, moved(west, 0.6, kFloor + 1.75, 2.3), 2.2);
    addPane(mesh, moved(west, -1.5, 0, 0));
}

}  // namespace shadowcache::scenes::courtyard
