#include <cmath>

#include "scenes/courtyard_parts.h"

namespace shadowcache::scenes::courtyard {
namespace {

constexpr double kPath = 0.63;         // half the width of the paths that cross the court
constexpr double kPlatform = 2.15;     // of the fountain
constexpr double kStairFront = -2.15;  // of the stair, in the north side's frame
constexpr double kStairBack = -0.80;

/// A sett or flag: slightly tilted, never as high as its neighbour.
void addStone(SetMesh& mesh, double x0, double x1, double z0, double z1, double bevel,
              const Rgb& color, std::int64_t key) {
    constexpr double kJoint = 0.006;
    const Vec3d up =
        Vec3d(0.03 * (noise(key, 1) - 0.5), 1, 0.03 * (noise(key, 2) - 0.5)).normalized();
    const Vec3d x = Vec3d(up.y, -up.x, 0).normalized();
    const Placement at{Vec3d((x0 + x1) / 2, 0.012 * noise(key, 3) - 0.006, (z0 + z1) / 2), x, up,
                       x.cross(up)};
    addSlab(mesh, at, {-(x1 - x0) / 2 + kJoint, -0.05, -(z1 - z0) / 2 + kJoint},
            {(x1 - x0) / 2 - kJoint, 0, (z1 - z0) / 2 - kJoint}, bevel,
            plain(tinted(color, 0.22, 0.7 * noise(key, 4) + 0.3 * smoothNoise(at.origin / 1.5))));
}

void addSetts(SetMesh& mesh, int signX, int signZ) {
    constexpr int kRows = 30;  // along z: the long joints cross the view of whoever walks in
    constexpr double kLength = 0.30;
    const double width = (kHalfX - 0.4 - kPath) / kRows;
    for (int row = 0; row < kRows; ++row) {
        const double x0 = kPath + row * width;
        double z = kPath;
        for (int i = 0; z < kHalfZ - 0.4; ++i) {
            const auto key = (((signX + 1) * 2 + signZ + 1) * 100000 + row * 300 + i);
            const double length =
                i == 0 && row % 2 ? kLength / 2 : kLength * (0.8 + 0.4 * noise(key, 9));
            const double z1 = std::min(z + length, kHalfZ - 0.4);
            if (std::hypot(x0 + width / 2, (z + z1) / 2) > kPlatform - 0.2 && z1 - z > 0.05)
                addStone(mesh, signX < 0 ? -x0 - width : x0, signX < 0 ? -x0 : x0 + width,
                         signZ < 0 ? -z1 : z, signZ < 0 ? -z : z1, 0.022, kCobble, key);
            z = z1;
        }
    }
}

void addFlags(SetMesh& mesh) {
    constexpr double kSize = kPath;
    const auto flag = [&](double x, double z, std::int64_t key) {
        if (std::hypot(x + kSize / 2, z + kSize / 2) < kPlatform - 0.35) return;
        addStone(mesh, x, x + kSize, z, z + kSize, 0.012, kSlab, key);
    };
    for (int i = 0; i < 28; ++i)
        for (int j = -1; j < 1; ++j) flag((i - 14) * kSize, j * kSize, (7000 + i * 2 + j));
    for (int i = 0; i < 18; ++i) {
        if (i == 8 || i == 9) continue;
        for (int j = -1; j < 1; ++j) flag(j * kSize, (i - 9) * kSize, (8000 + i * 2 + j));
    }
}

}  // namespace

void addPavement(SetMesh& mesh) {
    addPatch(  // joints between the stones, and the ground that the house covers
        mesh, 1, 1, [](double u, double v) { return Vec3d(-15 + 28.5 * v, -0.05, -10 + 20 * u); },
        plain({0.13f, 0.12f, 0.09f}));
    for (const int x : {-1, 1})
        for (const int z : {-1, 1}) addSetts(mesh, x, z);
    addFlags(mesh);
}

void addFountain(SetMesh& mesh) {
    const Placement at = moved({}, 0, 0, 0, kPi / 8);
    const Paint stone = weathered(tinted(kStone, 0.1, 0.7), 0.18, 0.6);
    const Imath::V2d platform[] = {
        {kPlatform, -0.05}, {kPlatform, 0.12}, {kPlatform - 0.03, 0.15}, {1.2, 0.16}};
    addLathe(mesh, at, platform, 8, weathered(kSlab, 0.14, 0.5));
    const Imath::V2d basin[] = {{1.66, 0.14}, {1.66, 0.24}, {1.60, 0.27}, {1.55, 0.33},
                                {1.55, 0.60}, {1.58, 0.64}, {1.68, 0.69}, {1.70, 0.76},
                                {1.68, 0.79}, {1.42, 0.79}, {1.40, 0.76}, {1.38, 0.3}};
    addLathe(mesh, at, basin, 8, stone);
    const auto water = [&](double radius, double y) {
        addPatch(
            mesh, 10, 48,
            [&](double u, double v) {
                const double r = radius * (1 - u);
                const double angle = 2 * kPi * (v < 1 ? v : 0);
                return Vec3d(r * std::cos(angle), y + 0.008 * std::sin(r * 22 + 1),
                             r * std::sin(angle));
            },
            weathered(kWater, 0.3, 0.35, Finish::water));
    };
    water(1.5, 0.66);
    const Imath::V2d pedestal[] = {
        {0.42, 0.3},  {0.42, 0.82}, {0.36, 0.88}, {0.24, 0.95}, {0.17, 1.05}, {0.15, 1.15},
        {0.20, 1.27}, {0.22, 1.33}, {0.16, 1.39}, {0.18, 1.44}, {0.42, 1.52}, {0.66, 1.60},
        {0.80, 1.70}, {0.84, 1.76}, {0.82, 1.79}, {0.76, 1.78}, {0.6, 1.68},  {0.3, 1.62}};
    addLathe(mesh, {}, pedestal, 40, weathered(tinted(kStone, 0.1, 0.7), 0.18, 0.6, Finish::honed));
    water(0.78, 1.735);
    const Imath::V2d stem[] = {{0.16, 1.6},   {0.16, 1.8},  {0.12, 1.84}, {0.08, 1.93},
                               {0.075, 2.02}, {0.11, 2.10}, {0.12, 2.14}, {0.09, 2.19},
                               {0.24, 2.26},  {0.35, 2.34}, {0.36, 2.38}, {0.32, 2.38},
                               {0.12, 2.32},  {0.07, 2.36}, {0.06, 2.44}, {0.10, 2.48},
                               {0.14, 2.58},  {0.12, 2.70}, {0.06, 2.79}, {0, 2.84}};
    addLathe(mesh, {}, stem, 28, weathered(kBronze, 0.15, 0.3, Finish::bronze));
    for (int i = 0; i < 8; ++i) {  // panels of the basin
        const Placement side = moved({}, 0, 0, 0, i * kPi / 4);
        const double face = 1.55 * std::cos(kPi / 8);
        addBox(mesh, side, {-0.44, 0.36, face - 0.05}, {0.44, 0.57, face + 0.03}, stone);
    }
}

void addStair(SetMesh& mesh) {
    const Placement side = sides()[static_cast<std::size_t>(Facing::north)].at;
    // Its own frame: x up the flight (toward -x of the world), z away from the court's middle.
    const Placement at{side(-kLandingHigh, 0, kStairBack), Vec3d(-1, 0, 0), Vec3d(0, 1, 0),
                       Vec3d(0, 0, -1)};
    const double width = kStairBack - kStairFront;
    constexpr int kSteps = 26;
    constexpr double kTread = 0.24;
    constexpr double kFoot = -kSteps * kTread;
    const Paint wall = weathered(kPlaster, 0.17, 0.9);
    const double rise = kUpperFloor / kSteps;
    const Placement inner = moved(at, 0, 0, -width);
    const double slope = kUpperFloor / -kFoot;
    const auto under = [&](double x) { return kUpperFloor + slope * x - 0.12; };
    const Imath::V2d ramp[] = {{kFoot + 0.2, -0.05},
                               {-1.5, -0.05},
                               {-1.5, under(-1.5)},
                               {kFoot + 0.2, under(kFoot + 0.2)}};
    const Imath::V2d head[] = {{-1.5, 2.9},
                               {1.5, 2.9},
                               {1.5, kUpperFloor - 0.12},
                               {0, kUpperFloor - 0.12},
                               {-1.5, under(-1.5)}};
    addPrism(mesh, inner, ramp, width, wall);
    addPrism(mesh, inner, head, width, wall);
    const Arch arch{1.5, 1.15, 1.55, 2.92, width, 16};
    addArchWall(mesh, moved(inner, 0, 0, width / 2), arch, wall);
    addArchivolt(mesh, inner, arch, 0, 0.2, weathered(kStone, 0.12, 0.7));
    for (const double x : {-1.5, 1.15})
        addBox(mesh, inner, {x, -0.05, 0}, {x + 0.35, 1.55, width}, weathered(kStone, 0.13, 0.6));
    for (int i = 0; i < kSteps; ++i)
        addSlab(mesh, inner, {kFoot + i * kTread - 0.02, i * rise - 0.05, 0.0},
                {kFoot + (i + 1) * kTread + 0.02, (i + 1) * rise, width}, 0.012,
                plain(tinted(kSlab, 0.12, noise(i, 61))));
    addBox(mesh, inner, {0.0, kUpperFloor - 0.2, 0}, {1.5, kUpperFloor - 0.006, width},
           weathered(kSlab, 0.12, 0.6));
    // The bridge from the landing to the gallery.
    addBox(mesh, inner, {0.0, kUpperFloor - 0.2, width - 0.02},
           {1.5, kUpperFloor - 0.01, width + 0.62}, weathered(kSlab, 0.12, 0.6));
    const auto parapet = [&](double z) {
        const Placement edge = moved(inner, 0, 0, z);
        const Imath::V2d rail[] = {{kFoot, 0.0},
                                   {kFoot + 0.3, 0.0},
                                   {0, kUpperFloor - 0.25},
                                   {0, kUpperFloor + 0.85},
                                   {kFoot, 0.95}};
        addPrism(mesh, edge, rail, 0.16, wall);
        const Imath::V2d coping[] = {{kFoot - 0.06, 0.93},
                                     {0.02, kUpperFloor + 0.85},
                                     {0.02, kUpperFloor + 0.93},
                                     {kFoot - 0.06, 1.01}};
        addPrism(mesh, moved(edge, 0, 0, -0.04), coping, 0.24, weathered(kStone, 0.12, 0.6));
    };
    parapet(width - 0.14);
    parapet(-0.02);
    addBox(mesh, inner, {-0.01, kUpperFloor - 0.25, -0.02}, {1.5, kUpperFloor + 0.85, 0.14}, wall);
    addBox(mesh, inner, {1.36, kUpperFloor - 0.25, -0.02}, {1.52, kUpperFloor + 0.85, width + 0.62},
           wall);
    addSlab(mesh, inner, {-0.03, kUpperFloor + 0.845, -0.06}, {1.56, kUpperFloor + 0.93, 0.18},
            0.015, weathered(kStone, 0.12, 0.6));
    addSlab(mesh, inner, {1.32, kUpperFloor + 0.842, 0.1},
            {1.56, kUpperFloor + 0.925, width + 0.62}, 0.015, weathered(kStone, 0.12, 0.6));
    addBox(mesh, inner, {-0.1, kUpperFloor - 0.2, width + 0.01},
           {0.02, kUpperFloor + 0.85, width + 0.62}, wall);
    for (const double z : {width - 0.06, 0.06}) {  // newel posts at the foot
        const Placement post = moved(inner, kFoot - 0.1, 0, z);
        addBox(mesh, post, {-0.16, -0.05, -0.16}, {0.16, 1.08, 0.16}, weathered(kStone, 0.12, 0.6));
        addSlab(mesh, post, {-0.2, 1.06, -0.2}, {0.2, 1.15, 0.2}, 0.02,
                weathered(kStone, 0.12, 0.6));
        const Imath::V2d ball[] = {{0.08, 1.14}, {0.06, 1.18}, {0.12, 1.23},
                                   {0.15, 1.32}, {0.12, 1.41}, {0, 1.46}};
        addLathe(mesh, post, ball, 16, weathered(kStone, 0.12, 0.6));
    }
}

}  // namespace shadowcache::scenes::courtyard
