#include <cmath>

#include "scenes/courtyard_parts.h"

namespace shadowcache::scenes::courtyard {
namespace {

constexpr double kInner = kRoomHalf - 0.1;  // half the room's width
constexpr double kCeiling = 4.25;
constexpr double kFront = 0.17;  // inner face of the wall toward the court

void addShell(SetMesh& mesh, const Placement& at) {
    const Paint plaster = weathered({0.72f, 0.65f, 0.52f}, 0.1, 1.2);
    const auto wall = [&](const Vec3d& a, const Vec3d& b) {
        addPatch(
            mesh, 12, 8,
            [&](double u, double v) {
                const Vec3d p = a + (b - a) * u;
                return at(p.x, kFloor + (kUpperFloor - 0.2 - kFloor) * v, p.z);
            },
            plaster);
    };
    wall({-kInner, 0, kRoomDepth}, {-kInner, 0, 0});
    wall({kInner, 0, kRoomDepth}, {-kInner, 0, kRoomDepth});
    wall({kInner, 0, 0}, {kInner, 0, kRoomDepth});
    // The same walls seen from the arcade's ends, and the room's outside.
    const Paint outside = weathered(kPlaster, 0.16, 1.1);
    for (const double s : {-1.0, 1.0})
        addPatch(
            mesh, 8, 8,
            [&](double u, double v) {
                const double z = s > 0 ? kShell * u : kShell * (1 - u);
                return at(s * kRoomHalf, kFloor - 0.05 + (kUpperFloor - kFloor) * v, z);
            },
            outside);
    addBox(mesh, at, {-kRoomHalf - 0.3, -0.05, kRoomDepth + 0.2},
           {kRoomHalf + 0.3, kUpperFloor, kRoomDepth + 0.5}, outside);
    for (const double x : {-kRoomHalf - 0.3, kRoomHalf})
        addBox(mesh, at, {x, -0.05, kShell - 0.1}, {x + 0.3, kUpperFloor, kRoomDepth + 0.3},
               outside);
    addBox(mesh, at, {-kRoomHalf - 0.3, kCeiling + 0.25, kShell - 0.1},
           {kRoomHalf + 0.3, kUpperFloor + 0.1, kRoomDepth + 0.5}, outside);

    for (int i = 0; i < 22; ++i)  // floor boards
        addQuad(mesh,
                {at(-kInner + i * 2 * kInner / 22, kFloor, 0.0),
                 at(-kInner + i * 2 * kInner / 22, kFloor, kRoomDepth),
                 at(-kInner + (i + 1) * 2 * kInner / 22, kFloor, kRoomDepth),
                 at(-kInner + (i + 1) * 2 * kInner / 22, kFloor, 0.0)},
                plain(tinted({0.36f, 0.21f, 0.11f}, 0.2, noise(i, 41)), Finish::varnished));
    addQuad(mesh,
            {at(-kInner, kCeiling, 0), at(kInner, kCeiling, 0), at(kInner, kCeiling, kRoomDepth),
             at(-kInner, kCeiling, kRoomDepth)},
            plain(tinted(kWood, 0.1, 0.9)));
    for (int i = 0; i < 8; ++i) {
        const double x = -kInner + 0.35 + i * (2 * kInner - 0.7) / 7;
        addBox(mesh, at, {x - 0.08, kCeiling - 0.2, 0.05}, {x + 0.08, kCeiling + 0.01, kRoomDepth},
               weathered(kWood, 0.2, 0.8));
    }
}

/// The infill of an arch toward the court, with a hole in it, framed in stone.
void addFront(SetMesh& mesh, const Placement& at, double center, const Opening& hole) {
    const Paint plaster = weathered(tinted(kPlaster, 0.1, 0.75), 0.15, 0.9);
    const Placement bay = moved(at, center, 0, 0);
    addPiercedWall(mesh, bay, {-1.5, 1.5, kFloor - 0.02, 4.2}, hole, -0.02, kFront, plaster);
    addBox(mesh, bay, {-1.5, 4.15, -0.01}, {1.5, kUpperFloor - 0.1, kFront}, plaster);
    const Paint stone = weathered(kStone, 0.13, 0.5);
    const double w = 0.15;
    addBox(mesh, bay, {hole.x0 - w, hole.y0, -0.08}, {hole.x0, hole.y1, 0.06}, stone);
    addBox(mesh, bay, {hole.x1, hole.y0, -0.08}, {hole.x1 + w, hole.y1, 0.06}, stone);
    addBox(mesh, bay, {hole.x0 - w - 0.05, hole.y1, -0.1},
           {hole.x1 + w + 0.05, hole.y1 + 0.18, 0.06}, stone);
    addBox(mesh, bay, {hole.x0 - w - 0.1, hole.y1 + 0.175, -0.16},
           {hole.x1 + w + 0.1, hole.y1 + 0.24, 0.06}, stone);
}

void addDoorLeaf(SetMesh& mesh, const Placement& hinge, double width, double height, double side) {
    for (int i = 0; i < 4; ++i) {
        const double x0 = width * i / 4 + 0.004;
        const double x1 = width * (i + 1) / 4 - 0.004;
        addBox(mesh, hinge, {side > 0 ? x0 : -x1, 0.01, -0.025},
               {side > 0 ? x1 : -x0, height, 0.02},
               plain(tinted(kShutter, 0.25, noise(i, 31)), Finish::varnished));
    }
    for (const double y : {0.25, 0.5 * height, height - 0.25})
        addBox(mesh, hinge, {side > 0 ? 0.02 : -width + 0.02, y - 0.05, -0.05},
               {side > 0 ? width - 0.02 : -0.02, y + 0.05, 0.045},
               plain(tinted(kShutter, 0.2, 0.2), Finish::varnished));
}

void addWindowBars(SetMesh& mesh, const Placement& bay, const Opening& hole) {
    const Paint paint = plain(kShutter, Finish::varnished);
    const auto bar = [&](double x0, double x1, double y0, double y1) {
        addBox(mesh, bay, {x0, y0, 0.06}, {x1, y1, 0.11}, paint);
    };
    bar(hole.x0, hole.x0 + 0.06, hole.y0, hole.y1);
    bar(hole.x1 - 0.06, hole.x1, hole.y0, hole.y1);
    bar(hole.x0, hole.x1, hole.y0, hole.y0 + 0.06);
    bar(hole.x0, hole.x1, hole.y1 - 0.06, hole.y1);
    bar(-0.035, 0.035, hole.y0, hole.y1);
    for (int i = 1; i < 3; ++i) {
        const double y = hole.y0 + (hole.y1 - hole.y0) * i / 3;
        bar(hole.x0, hole.x1, y - 0.018, y + 0.018);
    }
}

void addTable(SetMesh& mesh, const Placement& at) {
    const Paint wood = weathered({0.27f, 0.145f, 0.07f}, 0.25, 0.4, Finish::varnished);
    addBox(mesh, at, {-0.95, 0.72, -0.45}, {0.95, 0.77, 0.45}, wood);
    addBox(mesh, at, {-0.82, 0.62, -0.34}, {0.82, 0.72, 0.34}, wood);
    const Imath::V2d leg[] = {{0.035, 0},   {0.05, 0.05}, {0.03, 0.1},   {0.05, 0.3},
                              {0.055, 0.4}, {0.03, 0.52}, {0.045, 0.56}, {0.045, 0.64}};
    for (const double x : {-0.78, 0.78})
        for (const double z : {-0.3, 0.3}) addLathe(mesh, moved(at, x, 0, z), leg, 12, wood);
    const Imath::V2d bowl[] = {{0.07, 0.77}, {0.08, 0.785}, {0.05, 0.80}, {0.13, 0.85},
                               {0.18, 0.92}, {0.17, 0.92},  {0.11, 0.86}, {0, 0.83}};
    addLathe(mesh, moved(at, 0.1, 0, 0.05), bowl, 24, plain({0.25f, 0.36f, 0.50f}, Finish::glazed));
    for (int i = 0; i < 5; ++i) {
        const Placement fruit = moved(at, 0.1 + 0.075 * std::cos(i * 1.3), 0.895 + 0.012 * i,
                                      0.05 + 0.075 * std::sin(i * 1.3));
        const Imath::V2d ball[] = {
            {0, -0.045}, {0.032, -0.032}, {0.045, 0}, {0.032, 0.032}, {0, 0.045}};
        addLathe(mesh, fruit, ball, 10,
                 plain(i % 2 ? Rgb(0.6f, 0.13f, 0.05f) : Rgb(0.74f, 0.4f, 0.06f)));
    }
    const Imath::V2d jug[] = {{0.07, 0.77},  {0.11, 0.84}, {0.12, 0.92}, {0.08, 1.01}, {0.05, 1.05},
                              {0.055, 1.10}, {0.07, 1.13}, {0.05, 1.12}, {0.035, 1.0}};
    addLathe(mesh, moved(at, -0.5, 0, -0.1), jug, 20, plain({0.62f, 0.58f, 0.50f}, Finish::glazed));
}

void addChair(SetMesh& mesh, const Placement& at) {
    const Paint wood = weathered({0.21f, 0.11f, 0.055f}, 0.25, 0.3, Finish::varnished);
    addBox(mesh, at, {-0.22, 0.43, -0.21}, {0.22, 0.465, 0.21}, plain({0.50f, 0.36f, 0.17f}));
    for (const double x : {-0.2, 0.2}) {
        addBox(mesh, at, {x - 0.02, 0, -0.2}, {x + 0.02, 0.45, -0.16}, wood);
        addBox(mesh, at, {x - 0.02, 0, 0.17}, {x + 0.02, 1.02, 0.21}, wood);
    }
    for (const double y : {0.62, 0.77, 0.92})
        addBox(mesh, at, {-0.19, y, 0.18}, {0.19, y + 0.07, 0.2}, wood);
}

void addShelf(SetMesh& mesh, const Placement& at) {
    const Paint wood = weathered({0.17f, 0.09f, 0.045f}, 0.25, 0.5, Finish::varnished);
    constexpr double kWidth = 0.9;
    constexpr double kTop = 2.4;
    for (const double x : {-kWidth, kWidth - 0.05})
        addBox(mesh, at, {x, 0, -0.34}, {x + 0.05, kTop, 0}, wood);
    addBox(mesh, at, {-kWidth + 0.04, 0, -0.03}, {kWidth - 0.04, kTop, -0.005}, wood);
    addBox(mesh, at, {-kWidth - 0.06, kTop, -0.4}, {kWidth + 0.06, kTop + 0.08, 0}, wood);
    const Rgb bindings[] = {{0.33f, 0.06f, 0.04f},
                            {0.07f, 0.13f, 0.20f},
                            {0.35f, 0.25f, 0.12f},
                            {0.10f, 0.16f, 0.08f},
                            {0.46f, 0.38f, 0.26f}};
    for (std::int64_t shelf = 0; shelf < 5; ++shelf) {
        const double y = 0.12 + 0.46 * static_cast<double>(shelf);
        addBox(mesh, at, {-kWidth + 0.04, y - 0.04, -0.32}, {kWidth - 0.04, y, -0.02}, wood);
        double x = -kWidth + 0.07;
        for (std::int64_t i = 0; x < kWidth - 0.14; ++i) {
            const double width = 0.03 + 0.04 * noise(shelf, i, 1);
            if (noise(shelf, i / 5, 2) > 0.2)
                addBox(mesh, at, {x, y, -0.28 + 0.05 * noise(shelf, i, 3)},
                       {x + width, y + 0.24 + 0.13 * noise(shelf, i, 4), -0.05},
                       plain(tinted(bindings[static_cast<std::size_t>(5 * noise(shelf, i, 6))], 0.3,
                                    noise(shelf, i, 5))));
            x += width + 0.003;
        }
    }
}

void addPicture(SetMesh& mesh, const Placement& at, double width, double height) {
    const Paint gold = plain(kGold, Finish::gilded);
    const double w = width / 2;
    addBox(mesh, at, {-w - 0.07, 0, -0.05}, {w + 0.07, 0.07, 0}, gold);
    addBox(mesh, at, {-w - 0.07, height + 0.07, -0.05}, {w + 0.07, height + 0.14, 0}, gold);
    addBox(mesh, at, {-w - 0.07, 0.065, -0.05}, {-w, height + 0.075, 0}, gold);
    addBox(mesh, at, {w, 0.065, -0.05}, {w + 0.07, height + 0.075, 0}, gold);
    addPatch(  // a landscape: sky over hills
        mesh, 24, 16,
        [&](double u, double v) { return at(w - 2 * w * u, 0.06 + (height + 0.02) * v, -0.02); },
        Paint{[&](const Vec3d& p) {
            const double v = (p - at.origin).dot(at.y) / height;
            const double x = (p - at.origin).dot(at.x);
            const double hill = 0.35 + 0.12 * std::sin(4 * x) + 0.05 * std::sin(11 * x);
            if (v > hill)
                return Rgb(0.28f, 0.38f, 0.48f) +
                       Rgb(0.25f, 0.12f, 0.0f) * static_cast<float>(1 - v);
            return tinted({0.16f, 0.20f, 0.07f}, 0.5, v / hill);
        }});
}

}  // namespace

void addRoom(SetMesh& mesh) {
    const Placement at = sides()[static_cast<std::size_t>(Facing::west)].at;
    addShell(mesh, at);
    const Opening door{-0.72, 0.72, kFloor - 0.01, 2.75};
    addFront(mesh, at, 1.5, door);
    addFront(mesh, at, -1.5, kWindow);
    for (const double s : {-1.0, 1.0})
        addDoorLeaf(mesh, moved(at, 1.5 + s * 0.72, kFloor, 0.2, s * 1.75), 0.7, 2.4, -s);
    addWindowBars(mesh, moved(at, -1.5, 0, 0), kWindow);
    const Placement sill = moved(at, -1.5, 0, 0);
    addSlab(mesh, sill, {-0.85, 1.05, -0.2}, {0.85, 1.15, 0.05}, 0.015,
            weathered(kStone, 0.12, 0.5));

    const Placement floor = moved(at, 0, kFloor, 0);
    const Placement rug = moved(floor, 0.6, 0.008, 2.3, 0.06);
    addBox(mesh, rug, {-1.4, -0.005, -1.0}, {1.4, 0.004, 1.0}, plain({0.40f, 0.07f, 0.05f}));
    addBox(mesh, rug, {-1.25, 0, -0.85}, {1.25, 0.007, 0.85}, plain({0.11f, 0.10f, 0.22f}));
    addBox(mesh, rug, {-1.1, 0, -0.7}, {1.1, 0.010, 0.7}, plain({0.48f, 0.12f, 0.07f}));
    const Placement table = moved(floor, 0.6, 0.018, 2.3, 0.06);
    addTable(mesh, table);
    addChair(mesh, moved(table, -0.45, 0, 0.62, 0.1));
    addChair(mesh, moved(table, 0.5, 0, 0.66, -0.12));
    addChair(mesh, moved(table, -0.4, 0, -0.7, kPi + 0.2));
    addChair(mesh, moved(table, 1.25, 0, 0.1, kPi * 0.5 + 0.15));
    addShelf(mesh, moved(floor, 1.6, 0, kRoomDepth));
    addPicture(mesh, moved(floor, -0.9, 1.4, kRoomDepth), 1.3, 0.9);
    addBox(mesh, moved(floor, -1.4, 0, kRoomDepth - 0.36), {-0.75, 0, -0.3}, {0.75, 0.62, 0.3},
           weathered({0.2f, 0.1f, 0.05f}, 0.25, 0.4));
    addBox(mesh, moved(floor, -1.4, 0, kRoomDepth - 0.36), {-0.8, 0.62, -0.34}, {0.8, 0.68, 0.34},
           weathered({0.24f, 0.125f, 0.06f}, 0.25, 0.4));
    const Imath::V2d vase[] = {{0.07, 0.68}, {0.14, 0.78}, {0.15, 0.9}, {0.08, 1.02},
                               {0.06, 1.08}, {0.09, 1.12}, {0.07, 1.11}};
    addLathe(mesh, moved(floor, -1.8, 0, kRoomDepth - 0.36), vase, 20,
             plain({0.12f, 0.25f, 0.42f}, Finish::glazed));
}

}  // namespace shadowcache::scenes::courtyard
