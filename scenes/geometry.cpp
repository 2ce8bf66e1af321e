#include "scenes/geometry.h"

#include <algorithm>
#include <cmath>

#include "common/random/sequence.h"

namespace shadowcache::scenes {

double noise(std::int64_t a, std::int64_t b, std::int64_t c) {
    const auto word = [](std::int64_t v) { return static_cast<std::uint64_t>(v); };
    return toUnit(hashWords(word(a), word(b), word(c)));
}

double smoothNoise(const Vec3d& p) {
    const Vec3d cell{std::floor(p.x), std::floor(p.y), std::floor(p.z)};
    const auto fade = [](double t) { return t * t * (3 - 2 * t); };
    const Vec3d f{fade(p.x - cell.x), fade(p.y - cell.y), fade(p.z - cell.z)};
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const int dx = corner & 1;
        const int dy = (corner >> 1) & 1;
        const int dz = corner >> 2;
        const auto word = [](double c, int d) { return static_cast<std::int64_t>(c) + d; };
        sum += (dx ? f.x : 1 - f.x) * (dy ? f.y : 1 - f.y) * (dz ? f.z : 1 - f.z) *
               noise(word(cell.x, dx), word(cell.y, dy), word(cell.z, dz));
    }
    return sum;
}

Rgb tinted(const Rgb& base, double amount, double u) {
    const float f = static_cast<float>(1 + amount * (2 * u - 1));
    return {std::min(base.x * f, 0.95f), std::min(base.y * f, 0.95f), std::min(base.z * f, 0.95f)};
}

Placement moved(const Placement& at, double x, double y, double z, double yaw) {
    const double c = std::cos(yaw);
    const double s = std::sin(yaw);
    return {at(x, y, z), at.x * c - at.z * s, at.y, at.x * s + at.z * c};
}

int SetMesh::addVertex(const Vec3d& p, const Rgb& color) {
    positions.emplace_back(p);
    colors.push_back(color);
    return static_cast<int>(positions.size()) - 1;
}

void SetMesh::addTriangle(int a, int b, int c, Finish finish) {
    const Vec3d p(positions[static_cast<std::size_t>(a)]);
    const Vec3d q(positions[static_cast<std::size_t>(b)]);
    const Vec3d r(positions[static_cast<std::size_t>(c)]);
    if ((q - p).cross(r - p).length2() < 1e-16) return;
    triangles.emplace_back(a, b, c);
    finishes.push_back(finish);
}

Paint plain(const Rgb& color, Finish finish) {
    return {[color](const Vec3d&) { return color; }, finish};
}

Paint weathered(const Rgb& base, double amount, double size, Finish finish) {
    return {[=](const Vec3d& p) {
                return tinted(base, amount,
                              0.65 * smoothNoise(p / size) + 0.35 * smoothNoise(p * (3.1 / size)));
            },
            finish};
}

void addQuad(SetMesh& mesh, const std::array<Vec3d, 4>& corners, const Paint& paint) {
    std::array<int, 4> v{};
    for (std::size_t i = 0; i < 4; ++i) v[i] = mesh.addVertex(corners[i], paint(corners[i]));
    mesh.addTriangle(v[0], v[1], v[2], paint.finish);
    mesh.addTriangle(v[0], v[2], v[3], paint.finish);
}

void addPatch(SetMesh& mesh, int rows, int columns,
              const std::function<Vec3d(double u, double v)>& point, const Paint& paint) {
    const int first = static_cast<int>(mesh.positions.size());
    for (int i = 0; i <= rows; ++i) {
        for (int j = 0; j <= columns; ++j) {
            const Vec3d p = point(static_cast<double>(i) / rows, static_cast<double>(j) / columns);
            mesh.addVertex(p, paint(p));
        }
    }
    for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < columns; ++j) {
            const int a = first + i * (columns + 1) + j;
            const int b = a + columns + 1;
            mesh.addTriangle(a, b, b + 1, paint.finish);
            mesh.addTriangle(a, b + 1, a + 1, paint.finish);
        }
    }
}

void addBox(SetMesh& mesh, const Placement& at, const Vec3d& low, const Vec3d& high,
            const Paint& paint) {
    addSlab(mesh, at, low, high, 0, paint);
    addQuad(mesh,
            {at(low.x, low.y, low.z), at(high.x, low.y, low.z), at(high.x, low.y, high.z),
             at(low.x, low.y, high.z)},
            paint);
}

void addSlab(SetMesh& mesh, const Placement& at, const Vec3d& low, const Vec3d& high, double bevel,
             const Paint& paint) {
    const auto ring = [&](double y, double inset) {
        return std::array<Vec3d, 4>{
            at(low.x + inset, y, low.z + inset), at(low.x + inset, y, high.z - inset),
            at(high.x - inset, y, high.z - inset), at(high.x - inset, y, low.z + inset)};
    };
    const auto foot = ring(low.y, 0);
    const auto edge = ring(high.y - bevel, 0);
    const auto top = ring(high.y, bevel);
    addQuad(mesh, top, paint);
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t j = (i + 1) % 4;
        addQuad(mesh, {foot[i], foot[j], edge[j], edge[i]}, paint);
        if (bevel > 0) addQuad(mesh, {edge[i], edge[j], top[j], top[i]}, paint);
    }
}

void addLathe(SetMesh& mesh, const Placement& at, std::span<const Imath::V2d> profile, int segments,
              const Paint& paint) {
    const int rows = static_cast<int>(profile.size()) - 1;
    addPatch(
        mesh, rows, segments,
        [&](double u, double v) {
            const Imath::V2d& p = profile[static_cast<std::size_t>(std::lround(u * rows))];
            const double angle = 2 * kPi * (v < 1 ? v : 0);
            return at(p.x * std::cos(angle), p.y, p.x * std::sin(angle));
        },
        paint);
}

void addPrism(SetMesh& mesh, const Placement& at, std::span<const Imath::V2d> outline, double depth,
              const Paint& paint) {
    const std::size_t n = outline.size();
    const auto cap = [&](double z, bool front) {
        std::vector<int> v;
        for (const Imath::V2d& p : outline) {
            const Vec3d q = at(p.x, p.y, z);
            v.push_back(mesh.addVertex(q, paint(q)));
        }
        for (std::size_t i = 2; i < n; ++i)
            mesh.addTriangle(v[0], v[front ? i - 1 : i], v[front ? i : i - 1], paint.finish);
    };
    cap(0, false);
    cap(depth, true);
    for (std::size_t i = 0; i < n; ++i) {
        const Imath::V2d& p = outline[i];
        const Imath::V2d& q = outline[(i + 1) % n];
        addQuad(mesh, {at(p.x, p.y, 0), at(q.x, q.y, 0), at(q.x, q.y, depth), at(p.x, p.y, depth)},
                paint);
    }
}

void addMoulding(SetMesh& mesh, std::span<const PathPoint> path,
                 std::span<const Imath::V2d> profile, const Paint& paint) {
    const int rows = static_cast<int>(path.size()) - 1;
    const int columns = static_cast<int>(profile.size()) - 1;
    addPatch(
        mesh, rows, columns,
        [&](double u, double v) {
            const PathPoint& at = path[static_cast<std::size_t>(std::lround(u * rows))];
            const Imath::V2d& p = profile[static_cast<std::size_t>(std::lround(v * columns))];
            return at.position + at.outward * p.x + at.up * p.y;
        },
        paint);
}

}  // namespace shadowcache::scenes
