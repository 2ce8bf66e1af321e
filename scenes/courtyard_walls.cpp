#include <cmath>

#include "scenes/courtyard_parts.h"

namespace shadowcache::scenes::courtyard {

std::array<Side, 4> sides() {
    const Vec3d up(0, 1, 0);
    const auto side = [&](Facing facing, double x, double z, int bays) {
        const Vec3d out = Vec3d(x, 0, z).normalized();
        return Side{facing, {Vec3d(x, 0, z), up.cross(out), up, out}, bays};
    };
    return {side(Facing::south, 0, kHalfZ, 6), side(Facing::east, kHalfX, 0, 4),
            side(Facing::north, 0, -kHalfZ, 6), side(Facing::west, -kHalfX, 0, 4)};
}

void addArchWall(SetMesh& mesh, const Placement& at, const Arch& arch, const Paint& paint) {
    const int n = arch.segments;
    // Lower edge of the faces: the wall's corner, the arch, the wall's other corner.
    const auto edge = [&](double u) {
        const int k = static_cast<int>(std::lround(u * (n + 2))) - 1;
        if (k < 0) return Imath::V2d(-arch.halfWidth, arch.spring);
        if (k > n) return Imath::V2d(arch.halfWidth, arch.spring);
        const double angle = kPi * k / n;
        return Imath::V2d(-arch.radius * std::cos(angle),
                          arch.spring + arch.radius * std::sin(angle));
    };
    const auto topX = [&](double u) {
        const double t = std::clamp((u * (n + 2) - 1) / n, 0.0, 1.0);
        return -arch.halfWidth * std::cos(kPi * t);
    };
    const auto face = [&](double u, double v, double z) {
        const Imath::V2d low = edge(u);
        return at(low.x + (topX(u) - low.x) * v, low.y + (arch.top - low.y) * v, z);
    };
    const double z = arch.thickness / 2;
    addPatch(
        mesh, n + 2, 3, [&](double u, double v) { return face(1 - u, v, -z); }, paint);
    addPatch(
        mesh, n + 2, 3, [&](double u, double v) { return face(u, v, z); }, paint);
    addPatch(
        mesh, n, 1,
        [&](double u, double v) {
            const Imath::V2d p = edge((u * n + 1) / (n + 2));
            return at(p.x, p.y, z - 2 * z * v);
        },
        paint);
}

void addArchivolt(SetMesh& mesh, const Placement& at, const Arch& arch, double face, double width,
                  const Paint& paint) {
    std::vector<PathPoint> path;
    const int n = arch.segments;
    for (int i = 0; i <= n; ++i) {
        const double angle = kPi * i / n;
        const Vec3d radial = at.x * -std::cos(angle) + at.y * std::sin(angle);
        path.push_back({at(0, arch.spring, face) + radial * arch.radius, radial, -at.z});
    }
    const double w = width;
    const Imath::V2d profile[] = {{-0.012, -0.1},    {-0.012, 0.045},  {w * 0.30, 0.045},
                                  {w * 0.33, 0.03},  {w * 0.62, 0.03}, {w * 0.68, 0.055},
                                  {w * 0.92, 0.075}, {w, 0.075},       {w, -0.02}};
    addMoulding(mesh, path, profile, paint);
}

void addPiercedWall(SetMesh& mesh, const Placement& at, const Opening& wall, const Opening& hole,
                    double z0, double z1, const Paint& paint) {
    const auto panel = [&](double x0, double x1, double y0, double y1) {
        if (x1 - x0 < 1e-6 || y1 - y0 < 1e-6) return;
        const auto at2 = [&](double z, bool flip) {
            addPatch(
                mesh, 4, 4,
                [&](double u, double v) {
                    const double t = flip ? 1 - u : u;
                    return at(x0 + (x1 - x0) * t, y0 + (y1 - y0) * v, z);
                },
                paint);
        };
        at2(z0, true);
        at2(z1, false);
    };
    panel(wall.x0, hole.x0, wall.y0, wall.y1);
    panel(hole.x1, wall.x1, wall.y0, wall.y1);
    panel(hole.x0, hole.x1, wall.y0, hole.y0);
    panel(hole.x0, hole.x1, hole.y1, wall.y1);
    const auto reveal = [&](double xa, double ya, double xb, double yb) {
        addQuad(mesh, {at(xa, ya, z0), at(xa, ya, z1), at(xb, yb, z1), at(xb, yb, z0)}, paint);
    };
    reveal(hole.x0, hole.y0, hole.x0, hole.y1);
    reveal(hole.x0, hole.y1, hole.x1, hole.y1);
    reveal(hole.x1, hole.y1, hole.x1, hole.y0);
    reveal(hole.x1, hole.y0, hole.x0, hole.y0);
}

}  // namespace shadowcache::scenes::courtyard
