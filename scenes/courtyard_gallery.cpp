#include <cmath>

#include "scenes/courtyard_parts.h"

namespace shadowcache::scenes::courtyard {
namespace {

constexpr double kHalfBay = kBay / 4;  // half of the upper storey's bay
constexpr Arch kUpperArch{kHalfBay, 0.585, kUpperSpring, kUpperTop, 0.34, 12};

bool isLanding(const Side& side, double x) {
    const double world = side.at(x, 0, 0).x;
    return side.facing == Facing::north && world > kLandingLow && world < kLandingHigh;
}

void addColonnette(SetMesh& mesh, const Placement& at) {
    const Paint paint = weathered(kStone, 0.16, 0.5, Finish::honed);
    addBox(mesh, at, {-0.17, kUpperFloor - 0.02, -0.17}, {0.17, kRail - 0.09, 0.17}, paint);
    addSlab(mesh, at, {-0.15, kRail, -0.15}, {0.15, kRail + 0.07, 0.15}, 0.01, paint);
    const double y = kRail;
    const Imath::V2d profile[] = {{0.135, y + 0.07}, {0.145, y + 0.09},  {0.135, y + 0.115},
                                  {0.115, y + 0.13}, {0.112, y + 0.20},  {0.108, y + 0.7},
                                  {0.097, y + 1.20}, {0.115, y + 1.215}, {0.115, y + 1.24},
                                  {0.10, y + 1.25},  {0.105, y + 1.33},  {0.15, y + 1.46}};
    addLathe(mesh, at, profile, 14, paint);
    addBox(mesh, at, {-0.17, y + 1.455, -0.17}, {0.17, kUpperSpring, 0.17}, paint);
}

void addBaluster(SetMesh& mesh, const Placement& at) {
    const double y = kUpperFloor + 0.08;
    const Imath::V2d profile[] = {{0.055, y},        {0.055, y + 0.06}, {0.03, y + 0.10},
                                  {0.06, y + 0.25},  {0.057, y + 0.31}, {0.028, y + 0.50},
                                  {0.032, y + 0.62}, {0.055, y + 0.67}, {0.055, y + 0.75}};
    addLathe(mesh, at, profile, 8,
             plain(tinted(kStone, 0.1, noise((std::lround(at.origin.x * 100 + 5000)), 3))));
}

void addBalustrade(SetMesh& mesh, const Placement& at) {
    const Paint paint = weathered(kStone, 0.14, 0.7);
    addBox(mesh, at, {-kHalfBay, kUpperFloor - 0.02, -0.1}, {kHalfBay, kUpperFloor + 0.09, 0.1},
           paint);
    for (int i = 0; i < 4; ++i) addBaluster(mesh, moved(at, (i - 1.5) * 0.27, 0, 0));
    const double y = kRail;
    addBox(mesh, at, {-kHalfBay, y - 0.10, -0.14}, {kHalfBay, y - 0.03, 0.14}, paint);
    addSlab(mesh, at, {-kHalfBay, y - 0.04, -0.18}, {kHalfBay, y + 0.02, 0.18}, 0.015, paint);
}

/// Window with louvred shutters, closed, or half open.
void addShutters(SetMesh& mesh, const Placement& at, double y0, std::int64_t seed) {
    const Paint stone = weathered(kStone, 0.14, 0.5);
    const double w = 0.42;
    const double h = 1.35;
    const double z = kDepth;
    addBox(mesh, at, {-w - 0.12, y0 - 0.12, z - 0.12}, {w + 0.12, y0, z}, stone);
    addBox(mesh, at, {-w - 0.12, y0 + h, z - 0.08}, {w + 0.12, y0 + h + 0.14, z}, stone);
    for (const int s : {-1, 1})
        addBox(mesh, at, {s > 0 ? w : -w - 0.12, y0, z - 0.06}, {s > 0 ? w + 0.12 : -w, y0 + h, z},
               stone);
    addQuad(mesh,
            {at(w, y0, z - 0.005), at(-w, y0, z - 0.005), at(-w, y0 + h, z - 0.005),
             at(w, y0 + h, z - 0.005)},
            plain({0.03f, 0.03f, 0.035f}));
    for (const int s : {-1, 1}) {
        const double open = 0.25 + 1.1 * noise(seed, (s + 1));
        const Placement leaf = moved(at, s * w, y0, z - 0.06, s * open);
        const auto slat = [&](double x0, double x1, double ya, double yb) {
            addBox(mesh, leaf, {s > 0 ? -x1 : x0, ya, -0.03}, {s > 0 ? -x0 : x1, yb, 0},
                   plain(kShutter, Finish::varnished));
        };
        slat(0.0, 0.05, 0, h);
        slat(w - 0.05, w, 0, h);
        for (int i = 0; i < 11; ++i) slat(0.04, w - 0.04, 0.03 + i * 0.12, 0.12 + i * 0.12);
    }
}

}  // namespace

void addGallery(SetMesh& mesh, const Side& side) {
    const double end = side.half();
    const int bays = side.bays * 2;
    for (int bay = 0; bay < bays; ++bay) {
        const double x = -end + (bay + 0.5) * kBay / 2;
        const Placement at = moved(side.at, x, 0, 0);
        addArchWall(mesh, at, kUpperArch, weathered(kPlaster, 0.17, 0.9));
        addArchivolt(mesh, at, kUpperArch, -0.17, 0.15, weathered(kStone, 0.12, 0.7));
        if (bay > 0) addColonnette(mesh, moved(at, -kHalfBay, 0, 0));
        if (!isLanding(side, x)) addBalustrade(mesh, at);
        if (bay % 4 == 1)
            addShutters(mesh, at, kUpperFloor + 0.95, (bay * 4 + static_cast<int>(side.facing)));
        addBox(mesh, at, {-0.07, kUpperTop - 0.24, 0.1}, {0.07, kUpperTop - 0.02, kDepth},
               weathered(kWood, 0.2, 0.8));
        addBox(mesh, at, {kHalfBay - 0.07, kUpperTop - 0.24, 0.1},
               {kHalfBay + 0.07, kUpperTop - 0.02, kDepth}, weathered(kWood, 0.2, 0.8));
    }
    addPatch(
        mesh, 40, 6,
        [&](double u, double v) {
            const double reach = end + kDepth;
            return side.at(reach - 2 * reach * u, kUpperFloor + (kUpperTop - kUpperFloor) * v,
                           kDepth);
        },
        weathered(kPlaster, 0.16, 1.1));
    addPatch(  // the ceiling's boards, mitred at the corners
        mesh, 1, 1,
        [&](double u, double v) {
            const double z = kDepth * v;
            return side.at((2 * u - 1) * (end + z), kUpperTop - 0.01, z);
        },
        plain(tinted(kWood, 0.1, 0.9)));
}

void addTerrace(SetMesh& mesh, const Side& side) {
    const double end = side.half();
    const Paint stone = weathered(kStone, 0.14, 0.6);
    const Paint plaster = weathered(kPlaster, 0.16, 1.0);
    for (int bay = 0; bay < side.bays * 2; ++bay) {
        const Placement at = moved(side.at, -end + (bay + 0.5) * kBay / 2, 0, 0);
        addBalustrade(mesh, at);
        if (bay == 0) continue;
        const Placement post = moved(at, -kHalfBay, 0, 0);
        addBox(mesh, post, {-0.17, kUpperFloor - 0.02, -0.17}, {0.17, kRail, 0.17}, stone);
        addSlab(mesh, post, {-0.21, kRail - 0.01, -0.21}, {0.21, kRail + 0.07, 0.21}, 0.015, stone);
        if (bay % 2) continue;
        const double y = kRail + 0.06;
        const Imath::V2d urn[] = {{0.11, y},        {0.11, y + 0.04}, {0.05, y + 0.09},
                                  {0.09, y + 0.14}, {0.19, y + 0.30}, {0.18, y + 0.40},
                                  {0.12, y + 0.47}, {0.17, y + 0.53}, {0.06, y + 0.58},
                                  {0.05, y + 0.64}, {0, y + 0.68}};
        addLathe(mesh, post, urn, 18, stone);
    }
    addPatch(
        mesh, 16, 6,
        [&](double u, double v) {
            const double reach = end + kShell;
            return side.at(-reach + 2 * reach * u, -0.1 + 5.7 * v, kShell);
        },
        plaster);
    addBox(mesh, side.at, {-end, kUpperFloor - 0.1, kDepth - 0.05}, {end, kRail, kShell + 0.02},
           plaster);
    addSlab(mesh, side.at, {-end, kRail - 0.01, kDepth - 0.11}, {end, kRail + 0.08, kShell + 0.08},
            0.02, stone);
    for (const double x : {-end - kShell, end})  // the ends of the wings beside it
        addBox(mesh, side.at, {x + 0.02, kUpperFloor - 0.1, 0},
               {x + kShell - 0.02, kEaves + 0.3, kShell - 0.02}, plaster);
}

}  // namespace shadowcache::scenes::courtyard
