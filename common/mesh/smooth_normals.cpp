#include "common/mesh/smooth_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "common/base/parallel.h"
#include "common/mesh/placed_mesh.h"
#include "common/mesh/point_table.h"

namespace shadowcache {

namespace {

constexpr std::size_t kSmoothedPerChunk = 1 << 14;

/// Cosine beyond which a mean is the triangle's own normal: a few ulp of float.
constexpr double kFlat = 1 - 1e-6;

using Corners = std::array<std::uint32_t, 3>;
using CornerNormals = std::array<Vec3f, 3>;

/// Triangles, and what is around their corners.
struct Neighbourhood {
    std::vector<Corners> triangles;            ///< numbers of welded vertices
    std::vector<Vec3d> normal;                 ///< unit, by triangle
    std::vector<std::array<double, 3>> angle;  ///< at each corner
    std::vector<std::size_t> start;            ///< by vertex, into `around`
    std::vector<std::uint32_t> around;         ///< corners: 3 * triangle + corner
};

double angleBetween(const Vec3d& a, const Vec3d& b) {
    return std::atan2(a.cross(b).length(), a.dot(b));
}

Neighbourhood neighbourhood(const TriangleMesh& mesh, std::size_t first, std::size_t count) {
    Neighbourhood n;
    PointTable table(count);
    for (std::size_t i = first; i < first + count; ++i) {
        std::array<Vec3d, 3> p;
        Corners& corners = n.triangles.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
            const int vertex = mesh.triangles[i][static_cast<int>(k)];
            const Vec3f& position = mesh.positions[static_cast<std::size_t>(vertex)];
            corners[k] = table.add(position);
            p[k] = Vec3d(position);
        }
        n.normal.push_back((p[1] - p[0]).cross(p[2] - p[0]).normalized());
        n.angle.push_back({angleBetween(p[1] - p[0], p[2] - p[0]),
                           angleBetween(p[2] - p[1], p[0] - p[1]),
                           angleBetween(p[0] - p[2], p[1] - p[2])});
    }
    n.start.assign(table.points().size() + 2, 0);
    for (const Corners& corners : n.triangles)
        for (const std::uint32_t vertex : corners) ++n.start[vertex + 2];
    for (std::size_t v = 2; v < n.start.size(); ++v) n.start[v] += n.start[v - 1];
    n.around.resize(3 * count);
    // start[v + 1] runs from its group's start to its end, which leaves the starts in place.
    for (std::uint32_t corner = 0; corner < 3 * count; ++corner)
        n.around[n.start[n.triangles[corner / 3][corner % 3] + 1]++] = corner;
    return n;
}

/// @return whether any differs from the triangle's own normal
bool average(const Neighbourhood& n, std::size_t triangle, double leastCosine,
             CornerNormals& normals) {
    const Vec3d& own = n.normal[triangle];
    bool curved = false;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t vertex = n.triangles[triangle][k];
        Vec3d sum(0.0);
        for (std::size_t i = n.start[vertex]; i < n.start[vertex + 1]; ++i) {
            const Vec3d& other = n.normal[n.around[i] / 3];
            if (other.dot(own) >= leastCosine)
                sum += other * n.angle[n.around[i] / 3][n.around[i] % 3];
        }
        const Vec3d mean = sum.length() > 0 ? sum.normalized() : own;
        curved |= mean.dot(own) < kFlat;
        normals[k] = Vec3f(mean);
    }
    return curved;
}

/// Of the triangles of one space: those in the world, or a group of instances.
void smooth(TriangleMesh& mesh, std::size_t first, std::size_t count, double leastCosine,
            int firstNumber, PointTable& made) {
    const Neighbourhood n = neighbourhood(mesh, first, count);
    std::vector<CornerNormals> normals(count);
    std::vector<char> curved(count, 0);
    parallelFor(count, kSmoothedPerChunk, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const Vec3i& given = mesh.cornerNormals[first + i];
            if (given.x < 0 || given.y < 0 || given.z < 0)
                curved[i] = average(n, i, leastCosine, normals[i]) ? 1 : 0;
        }
    });
    for (std::size_t i = 0; i < count; ++i)
        for (int k = 0; curved[i] && k < 3; ++k)
            mesh.cornerNormals[first + i][k] =
                firstNumber + static_cast<int>(made.add(normals[i][static_cast<std::size_t>(k)]));
}

}  // namespace

void smoothNormals(TriangleMesh& mesh, double degrees) {
    mesh.cornerNormals.resize(mesh.triangles.size(), Vec3i(-1, -1, -1));
    // Angles right at the crease are smooth, whatever is rounded off.
    const double leastCosine = std::cos(degrees * kPi / 180) - 1e-9;
    PointTable made(mesh.triangles.size());
    const auto firstNumber = static_cast<int>(mesh.normals.size());
    smooth(mesh, 0, directCount(mesh), leastCosine, firstNumber, made);
    std::set<std::uint32_t> groups;
    for (const MeshInstance& instance : mesh.instances)
        if (groups.insert(instance.firstPart).second)
            smooth(mesh, mesh.parts[instance.firstPart].firstTriangle, instance.triangleCount,
                   leastCosine, firstNumber, made);
    mesh.normals.insert(mesh.normals.end(), made.points().begin(), made.points().end());
    if (mesh.normals.empty()) mesh.cornerNormals.clear();
}

}  // namespace shadowcache
