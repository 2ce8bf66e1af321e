#include <cmath>

#include "scenes/courtyard_parts.h"

namespace shadowcache::scenes::courtyard {
namespace {

/// Unit vector, uniform over the sphere.
Vec3d randomDirection(std::int64_t a, std::int64_t b) {
    const double y = 2 * noise(a, b, 1) - 1;
    const double angle = 2 * kPi * noise(a, b, 2);
    const double r = std::sqrt(1 - y * y);
    return {r * std::cos(angle), y, r * std::sin(angle)};
}

/// Leaf of two triangles folded along its rib, from `root` along `direction`.
void addLeaf(SetMesh& mesh, const Vec3d& root, const Vec3d& direction, double length, double roll,
             const Rgb& color) {
    Vec3d s;
    Vec3d t;
    tangentFrame(direction, s, t);
    const Vec3d side = s * std::cos(roll) + t * std::sin(roll);
    const Vec3d fold = direction.cross(side);
    const Vec3d middle = root + direction * (0.5 * length);
    const int a = mesh.addVertex(root, color);
    const int b = mesh.addVertex(middle + side * (0.27 * length) + fold * (0.1 * length), color);
    const int c = mesh.addVertex(root + direction * length, color);
    const int d = mesh.addVertex(middle - side * (0.27 * length) + fold * (0.1 * length), color);
    mesh.addTriangle(a, b, c, Finish::waxed);
    mesh.addTriangle(a, c, d, Finish::waxed);
}

void addSphere(SetMesh& mesh, const Vec3d& center, double radius, int segments, const Rgb& color) {
    Placement at;
    at.origin = center;
    std::vector<Imath::V2d> profile;
    for (int i = 0; i <= segments / 2; ++i) {
        const double angle = 2 * kPi * i / segments;
        profile.emplace_back(radius * std::sin(angle), -radius * std::cos(angle));
    }
    addLathe(mesh, at, profile, segments, plain(color, Finish::waxed));
}

void addPot(SetMesh& mesh, const Placement& at) {
    const Paint clay = weathered(tinted(kTerracotta, 0.1, 0.8), 0.18, 0.3, Finish::glazed);
    const Imath::V2d profile[] = {{0.22, -0.02}, {0.25, 0.02},  {0.23, 0.06},  {0.30, 0.30},
                                  {0.315, 0.31}, {0.315, 0.35}, {0.305, 0.36}, {0.34, 0.52},
                                  {0.375, 0.53}, {0.39, 0.57},  {0.39, 0.63},  {0.36, 0.65},
                                  {0.34, 0.58},  {0.0, 0.57}};
    addLathe(mesh, at, profile, 28, clay);
}

}  // namespace

void addTree(SetMesh& mesh, const Placement& at, std::int64_t seed) {
    addPot(mesh, at);
    const double height = 1.45 + 0.3 * noise(seed, 1);
    const Vec3d lean(0.1 * (noise(seed, 2) - 0.5), 0, 0.1 * (noise(seed, 3) - 0.5));
    addPatch(
        mesh, 6, 8,
        [&](double u, double v) {
            const double angle = 2 * kPi * (v < 1 ? v : 0);
            const double r = 0.045 - 0.015 * u;
            return at(r * std::cos(angle), 0.55 + height * u, r * std::sin(angle)) +
                   lean * std::sin(3 * u);
        },
        plain({0.16f, 0.115f, 0.075f}));
    const Vec3d crown = at(0, 0.55 + height + 0.1, 0);
    const double radius = 0.58 + 0.12 * noise(seed, 4);
    for (std::int64_t i = 0; i < 1150; ++i) {
        const Vec3d d = randomDirection(seed, i);
        // Leaves fill the crown's outer shell, in clumps.
        const double clump = smoothNoise(d * 3.2 + Vec3d(static_cast<double>(seed)));
        const double r = radius * (0.70 + 0.42 * clump) * (0.80 + 0.25 * noise(seed, i, 7));
        const Vec3d root = crown + Vec3d(d.x * r, d.y * r * 0.92, d.z * r);
        const Vec3d direction =
            (d + randomDirection(seed + 50, i) * 0.9 + Vec3d(0, -0.15, 0)).normalized();
        const double u = noise(seed, i, 8);
        const Rgb green = u < 0.15 ? Rgb(0.16f, 0.26f, 0.05f) : Rgb(0.065f, 0.155f, 0.035f);
        addLeaf(mesh, root, direction, 0.10 + 0.05 * noise(seed, i, 9), kPi * noise(seed, i, 10),
                tinted(green, 0.35, noise(seed, i, 11)));
    }
    for (std::int64_t i = 0; i < 11; ++i) {
        const Vec3d d = randomDirection(seed + 99, i);
        addSphere(mesh, crown + Vec3d(d.x, d.y * 0.9 - 0.1, d.z) * (radius * 0.93), 0.042, 8,
                  tinted({0.78f, 0.27f, 0.025f}, 0.15, noise(seed, i, 12)));
    }
}

void addHedge(SetMesh& mesh, const Placement& at, double length, std::int64_t seed) {
    const Paint stone = weathered(kStone, 0.14, 0.5);
    const double half = length / 2;
    addBox(mesh, at, {-half, -0.03, -0.24}, {half, 0.34, 0.24}, weathered(kSlab, 0.15, 0.5));
    addSlab(mesh, at, {-half - 0.04, 0.33, -0.28}, {half + 0.04, 0.40, 0.28}, 0.015, stone);
    const auto leaves = static_cast<std::int64_t>(length * 600);
    addBox(mesh, at, {-half + 0.16, 0.38, -0.13}, {half - 0.16, 0.64, 0.13},
           plain({0.03f, 0.06f, 0.02f}));
    for (std::int64_t i = 0; i < leaves; ++i) {
        const double t = 2 * noise(seed, i, 1) - 1;
        const double x = i % 9 == 0 ? std::copysign(half - 0.05, t) : t * (half - 0.06);
        const double angle = kPi * (1.35 * noise(seed, i, 2) - 0.175);
        const double c = std::cos(angle);
        const double s = std::sin(angle);
        const double bump = 0.05 * smoothNoise(Vec3d(x * 4, angle * 2, static_cast<double>(seed)));
        // A rounded box in section; every ninth leaf covers one of the ends.
        const double edge =
            1 / std::pow(std::pow(std::abs(c) / 0.19, 4) + std::pow(std::abs(s) / 0.24, 4), 0.25);
        const double r = (i % 9 == 0 ? edge * std::sqrt(noise(seed, i, 6)) : edge) + bump;
        const Vec3d root = at(x, 0.56 + r * s, r * c);
        const Vec3d out = (at.z * c + at.y * s + randomDirection(seed, i) * 0.9).normalized();
        addLeaf(mesh, root, out, 0.05 + 0.03 * noise(seed, i, 3), kPi * noise(seed, i, 4),
                tinted({0.06f, 0.145f, 0.03f}, 0.45, noise(seed, i, 5)));
    }
}

void addBench(SetMesh& mesh, const Placement& at) {
    const Paint stone = weathered(kStone, 0.14, 0.5);
    addSlab(mesh, at, {-0.85, 0.40, -0.22}, {0.85, 0.48, 0.22}, 0.015, stone);
    addQuad(mesh,
            {at(-0.85, 0.40, -0.22), at(0.85, 0.40, -0.22), at(0.85, 0.40, 0.22),
             at(-0.85, 0.40, 0.22)},
            stone);
    const Imath::V2d foot[] = {{-0.20, -0.02}, {0.20, -0.02}, {0.20, 0.06},  {0.12, 0.12},
                               {0.12, 0.28},   {0.18, 0.41},  {-0.18, 0.41}, {-0.12, 0.28},
                               {-0.12, 0.12},  {-0.20, 0.06}};
    for (const double x : {-0.6, 0.6}) {
        const Placement leg{at(x - 0.07, 0, 0), -at.z, at.y, at.x};
        // The foot's outline is waisted: two convex halves.
        const Imath::V2d low[] = {foot[0], foot[1], foot[2], foot[3], foot[8], foot[9]};
        const Imath::V2d high[] = {foot[8], foot[3], foot[4], foot[5], foot[6], foot[7]};
        const Imath::V2d shaft[] = {high[0], high[1], high[2], high[5]};
        const Imath::V2d head[] = {high[5], high[2], high[3], high[4]};
        addPrism(mesh, leg, low, 0.14, stone);
        addPrism(mesh, leg, shaft, 0.14, stone);
        addPrism(mesh, leg, head, 0.14, stone);
    }
}

}  // namespace shadowcache::scenes::courtyard
