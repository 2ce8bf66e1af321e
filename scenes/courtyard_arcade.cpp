#include <cmath>

#include "scenes/courtyard_parts.h"

namespace shadowcache::scenes::courtyard {
namespace {

constexpr Arch kGroundArch{kBay / 2, 1.25, kSpring, kWallTop, 2 * kWallHalf, 18};

/// One leaf of a capital: a tongue that rises along the bell and curls outward.
void addCapitalLeaf(SetMesh& mesh, const Placement& at, double y, double radius, double height,
                    double halfWidth, const Paint& paint) {
    addPatch(
        mesh, 2, 5,
        [&](double u, double v) {
            const double curl = v * v * v;
            const double width = halfWidth * (1 - 0.75 * v * v);
            const double bulge = 0.02 * (1 - std::abs(2 * u - 1));
            return at((2 * u - 1) * width, y + height * (v - 0.35 * curl * v),
                      radius + bulge + 0.085 * curl + 0.025 * v);
        },
        paint);
}

void addColumn(SetMesh& mesh, const Placement& at) {
    const Paint paint = weathered(kStone, 0.16, 0.5, Finish::honed);
    addSlab(mesh, at, {-0.25, kFloor, -0.25}, {0.25, kFloor + 0.14, 0.25}, 0.012, paint);
    std::vector<Imath::V2d> profile = {{0.235, 0.44}, {0.25, 0.47},  {0.235, 0.50}, {0.205, 0.515},
                                       {0.20, 0.545}, {0.215, 0.56}, {0.215, 0.59}, {0.185, 0.61}};
    for (int i = 0; i <= 6; ++i) {  // the shaft swells a little: entasis
        const double t = i / 6.0;
        profile.emplace_back(0.178 - 0.026 * t * t, 0.63 + t * (2.22 - 0.63));
    }
    for (const Imath::V2d& p : {Imath::V2d(0.175, 2.235),
                                {0.178, 2.255},
                                {0.155, 2.275},
                                {0.155, 2.33},
                                {0.165, 2.45},
                                {0.20, 2.57},
                                {0.235, 2.61}})
        profile.push_back(p);
    addLathe(mesh, at, profile, 20, paint);
    for (int i = 0; i < 8; ++i) {
        addCapitalLeaf(mesh, moved(at, 0, 0, 0, i * kPi / 4), 2.29, 0.158, 0.20, 0.06, paint);
        addCapitalLeaf(mesh, moved(at, 0, 0, 0, (i + 0.5) * kPi / 4), 2.36, 0.165, 0.25, 0.05,
                       paint);
    }
    addBox(mesh, at, {-0.225, 2.605, -0.225}, {0.225, 2.655, 0.225}, paint);
    addBox(mesh, at, {-0.26, 2.65, -0.26}, {0.26, kSpring, 0.26}, paint);
}

/// Groin vault between four springers: the higher of two crossing barrels.
void addVault(SetMesh& mesh, const Placement& at, double x0, double x1, double z0, double z1) {
    constexpr int kCells = 12;
    addPatch(
        mesh, kCells, kCells,
        [&](double u, double v) {
            const double rise = std::max(std::sin(kPi * u), std::sin(kPi * v));
            return at((x0 + x1) / 2 - (x1 - x0) / 2 * std::cos(kPi * u), kSpring + 1.38 * rise,
                      (z0 + z1) / 2 - (z1 - z0) / 2 * std::cos(kPi * v));
        },
        weathered(Rgb(0.70f, 0.61f, 0.47f), 0.12, 1.3));
}

/// Rib across the arcade from the column to a corbel on the back wall.
void addRib(SetMesh& mesh, const Placement& at) {
    const Paint paint = weathered(kStone, 0.14, 0.6);
    const double center = (kDepth + kWallHalf) / 2;
    const double radius = (kDepth - kWallHalf) / 2 - 0.05;
    std::vector<PathPoint> path;
    for (int i = 0; i <= 12; ++i) {
        const double angle = kPi * i / 12;
        const Vec3d radial = at.z * -std::cos(angle) + at.y * std::sin(angle);
        path.push_back({at(0, kSpring, center) + at.z * (-std::cos(angle) * radius) +
                            at.y * (std::sin(angle) * 1.27),
                        radial, at.x});
    }
    const Imath::V2d profile[] = {{0.35, -0.22}, {0.03, -0.22}, {0.03, -0.15}, {0, -0.13},
                                  {0, 0.13},     {0.03, 0.15},  {0.03, 0.22},  {0.35, 0.22}};
    addMoulding(mesh, path, profile, paint);
    const Imath::V2d corbel[] = {{0.02, 2.30}, {0.07, 2.34},    {0.09, 2.42},
                                 {0.19, 2.56}, {0.24, 2.60},    {0.24, 2.66},
                                 {0.27, 2.68}, {0.27, kSpring}, {0, kSpring}};
    addLathe(mesh, moved(at, 0, 0, kDepth), corbel, 16, paint);
}

/// Roundel between two arches.
void addRoundel(SetMesh& mesh, const Placement& at, double y, double face) {
    const Placement disc{at(0, y, face + 0.01), at.x, -at.z, at.y};
    const Imath::V2d profile[] = {{0.27, 0},     {0.27, 0.05},  {0.245, 0.065},
                                  {0.21, 0.05},  {0.20, 0.025}, {0.11, 0.03},
                                  {0.10, 0.055}, {0.05, 0.07},  {0, 0.075}};
    addLathe(mesh, disc, profile, 18, plain(tinted(kStone, 0.05, 0.9)));
}

void addKeystone(SetMesh& mesh, const Placement& at, const Arch& arch, double size) {
    const double y = arch.spring + arch.radius;
    const Imath::V2d outline[] = {{-0.32 * size, y - 0.05},
                                  {0.32 * size, y - 0.05},
                                  {0.5 * size, y + 1.15 * size},
                                  {-0.5 * size, y + 1.15 * size}};
    addPrism(mesh, moved(at, 0, 0, -kWallHalf - 0.115), outline, 0.3, plain(kStone));
}

/// String course: the moulding that runs along the whole side at the height y.
void addCornice(SetMesh& mesh, const Side& side, double y, std::span<const Imath::V2d> profile) {
    std::vector<PathPoint> path;
    const int n = side.bays * 4;
    const double end = side.half();
    for (int i = 0; i <= n; ++i) {
        const double x = -end + 2 * end * i / n;
        Vec3d outward = -side.at.z;  // at the corners the mitre of two sides
        if (i == 0) outward += side.at.x;
        if (i == n) outward -= side.at.x;
        path.push_back({side.at(x, y, 0), outward, side.at.y});
    }
    addMoulding(mesh, path, profile, weathered(kStone, 0.12, 0.9));
}

void addBackWall(SetMesh& mesh, const Side& side, double x0, double x1, double y0, double y1) {
    const int cells = std::max(1, static_cast<int>((x1 - x0) / 0.5));
    addPatch(
        mesh, cells, 8,
        [&](double u, double v) { return side.at(x1 + (x0 - x1) * u, y0 + (y1 - y0) * v, kDepth); },
        weathered(kPlaster, 0.16, 1.1));
}

/// A closed door in a stone frame on the back wall.
void addClosedDoor(SetMesh& mesh, const Placement& at, double floor, double halfWidth,
                   double height, const Rgb& color) {
    const Paint stone = weathered(kStone, 0.14, 0.5);
    const double w = halfWidth;
    addBox(mesh, at, {-w - 0.16, floor, kDepth - 0.09}, {-w, floor + height, kDepth}, stone);
    addBox(mesh, at, {w, floor, kDepth - 0.09}, {w + 0.16, floor + height, kDepth}, stone);
    addBox(mesh, at, {-w - 0.24, floor + height, kDepth - 0.13},
           {w + 0.24, floor + height + 0.2, kDepth}, stone);
    const int planks = 6;
    for (int i = 0; i < planks; ++i) {
        const double x0 = -w + 2 * w * i / planks;
        addBox(mesh, at, {x0 + 0.006, floor + 0.02, kDepth - 0.04},
               {x0 + 2 * w / planks - 0.006, floor + height, kDepth},
               plain(tinted(color, 0.18, noise(i, 77)), Finish::varnished));
    }
    for (const double y : {0.25, 0.8})
        addBox(mesh, at, {-w + 0.05, floor + y * height - 0.06, kDepth - 0.065},
               {w - 0.05, floor + y * height + 0.06, kDepth - 0.03},
               plain(tinted(color, 0.2, 0.1), Finish::varnished));
}

/// Paving of the arcade in two tones, with worn joints shown by tint.
void addPaving(SetMesh& mesh, const Placement& at, double x0, double x1, double z0, double z1,
               double y) {
    const int nx = std::max(1, static_cast<int>(std::lround((x1 - x0) / 0.42)));
    const int nz = std::max(1, static_cast<int>(std::lround((z1 - z0) / 0.42)));
    const auto seed = (static_cast<std::int64_t>(1000 * (at.origin.x + 2 * at.origin.z)));
    for (int i = 0; i < nx; ++i) {
        for (int j = 0; j < nz; ++j) {
            const Rgb base = (i + j) % 2 ? Rgb(0.42f, 0.22f, 0.13f) : Rgb(0.56f, 0.47f, 0.36f);
            const double u = noise(i, j, seed);
            const double xa = x0 + (x1 - x0) * i / nx;
            const double xb = x0 + (x1 - x0) * (i + 1) / nx;
            const double za = z0 + (z1 - z0) * j / nz;
            const double zb = z0 + (z1 - z0) * (j + 1) / nz;
            addQuad(mesh, {at(xa, y, za), at(xa, y, zb), at(xb, y, zb), at(xb, y, za)},
                    plain(tinted(base, 0.14, u), Finish::glazed));
        }
    }
}

void addSteps(SetMesh& mesh, const Side& side) {
    const bool isLong = side.bays > 4;
    const auto course = [&](double front, double back, double top) {
        const double end = side.half() - (isLong ? 0 : -front);
        const int blocks = static_cast<int>(std::lround(2 * end / 1.1));
        for (int i = 0; i < blocks; ++i) {
            const double u = noise(i, static_cast<int>(side.facing), 5);
            addSlab(mesh, side.at, {-end + 2 * end * i / blocks + 0.002, -0.04, front},
                    {-end + 2 * end * (i + 1) / blocks - 0.002, top - 0.004 * u, back}, 0.015,
                    plain(tinted(kSlab, 0.14, u)));
        }
    };
    course(-0.45, 0.05, kFloor);
    course(-0.85, -0.40, kFloor / 2);
}

}  // namespace

void addGroundArcade(SetMesh& mesh, const Side& side) {
    addSteps(mesh, side);
    const double end = side.half();
    for (int bay = 0; bay < side.bays; ++bay) {
        const Placement at = moved(side.at, side.bayCenter(bay), 0, 0);
        addArchWall(mesh, at, kGroundArch, weathered(kPlaster, 0.17, 0.9));
        addArchivolt(mesh, at, kGroundArch, -kWallHalf, 0.235, weathered(kStone, 0.12, 0.7));
        addKeystone(mesh, at, kGroundArch, 0.24);
        if (bay > 0) {
            addColumn(mesh, moved(at, -kBay / 2, 0, 0));
            addRoundel(mesh, moved(at, -kBay / 2, 0, 0), 3.98, -kWallHalf);
        }
        if (side.isRoom(bay)) continue;
        addVault(mesh, at, -kBay / 2, kBay / 2, kWallHalf, kDepth);
        addPaving(mesh, at, -kBay / 2, kBay / 2, 0.05, kDepth, kFloor);
        if (bay % 2 == 1)
            addClosedDoor(mesh, at, kFloor, 0.55, 2.1, bay % 4 == 1 ? kShutter : kWood);
    }
    for (int k = 0; k <= side.bays; ++k) {
        const double x = -end + k * kBay;
        if (side.facing == Facing::west && std::abs(x) < kRoomHalf - 0.1) continue;
        addRib(mesh, moved(side.at, x, 0, 0));
    }
    const bool west = side.facing == Facing::west;
    addBackWall(mesh, side, -end - kDepth, west ? -kRoomHalf : end + kDepth, kFloor, kUpperFloor);
    if (west) addBackWall(mesh, side, kRoomHalf, end + kDepth, kFloor, kUpperFloor);
    const Imath::V2d string[] = {{kWallHalf, 0.02},        {kWallHalf + 0.05, 0.02},
                                 {kWallHalf + 0.05, 0.08}, {kWallHalf + 0.09, 0.10},
                                 {kWallHalf + 0.11, 0.16}, {kWallHalf + 0.19, 0.18},
                                 {kWallHalf + 0.19, 0.26}, {kWallHalf + 0.22, 0.30},
                                 {kWallHalf - 0.01, 0.30}, {-kDepth + 0.0, 0.30}};
    addCornice(mesh, side, kWallTop, string);
}

void addCorners(SetMesh& mesh) {
    for (const Side& side : sides()) {
        const double end = side.half();
        const Placement at = moved(side.at, end, 0, 0);
        addVault(mesh, at, kWallHalf, kDepth, kWallHalf, kDepth);
        addPaving(mesh, at, 0.05, kDepth, 0.05, kDepth, kFloor);
        const Paint paint = weathered(kStone, 0.13, 0.6);
        addBox(mesh, at, {-0.28, kFloor, -0.28}, {0.28, kUpperTop, 0.28}, paint);
        addSlab(mesh, at, {-0.34, kFloor - 0.01, -0.34}, {0.34, kFloor + 0.22, 0.34}, 0.02, paint);
        addBox(mesh, at, {-0.33, kSpring - 0.12, -0.33}, {0.33, kSpring, 0.33}, paint);
        addBox(mesh, at, {-0.33, kUpperSpring - 0.1, -0.33}, {0.33, kUpperSpring, 0.33}, paint);
    }
}

}  // namespace shadowcache::scenes::courtyard
