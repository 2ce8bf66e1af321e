#include "common/mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "common/error.h"
#include "common/mesh_reader.h"
#include "common/mesh_statistics.h"
#include "common/parallel.h"
#include "common/sequence.h"
#include "common/triangulate.h"

namespace shadowcache {

namespace {

constexpr std::size_t kTrianglesPerChunk = 1 << 16;

/// Coordinates beyond this are dropped: Embree ignores primitives beyond 1.8e18 silently.
constexpr double kMaxCoordinate = 1e18;

using Corners = std::array<std::uint32_t, 3>;

/// Triangles of all files so far, in world space.
struct Soup {
    std::vector<Vec3d> vertices;
    std::vector<Corners> triangles;
    std::vector<Rgb> colors;
    MeshReport report;
};

bool usable(const Vec3d& v) {
    // Written so that NaN fails.
    return std::abs(v.x) <= kMaxCoordinate && std::abs(v.y) <= kMaxCoordinate &&
           std::abs(v.z) <= kMaxCoordinate;
}

Vec3d toWorld(const Vec3d& v, const MeshOptions& options) {
    return (options.zUp ? Vec3d(v.x, v.z, -v.y) : v) * options.scale;
}

/// Cuts faces into triangles, at hand for one file after the other.
class FaceCutter {
public:
    FaceCutter(const std::filesystem::path& path, Soup& soup, std::size_t firstVertex)
        : path_(path), soup_(soup), firstVertex_(firstVertex) {
        used_.assign(soup.vertices.size() - firstVertex, false);
    }

    void add(std::span<const std::uint32_t> corners) {
        MeshReport& report = soup_.report;
        ++report.facesRead;
        for (const std::uint32_t corner : corners) {
            if (corner < used_.size()) used_[corner] = true;
        }
        if (corners.size() < 3) {
            ++report.degenerate;
            return;
        }
        const std::size_t triangles = corners.size() - 2;
        if (triangles > 1) {
            ++report.polygons;
            report.trianglesFromPolygons += triangles;
        }
        if (!std::all_of(corners.begin(), corners.end(), [&](auto corner) {
                return corner < used_.size() && usable(soup_.vertices[firstVertex_ + corner]);
            })) {
            report.badVertexFaces += triangles;
            return;
        }
        cut(corners);
    }

    std::size_t unreferenced() const {
        return static_cast<std::size_t>(std::count(used_.begin(), used_.end(), false));
    }

private:
    void cut(std::span<const std::uint32_t> corners) {
        points_.clear();
        pieces_.clear();
        for (const auto corner : corners) points_.push_back(soup_.vertices[firstVertex_ + corner]);
        if (!triangulate(points_, pieces_)) {
            throwFileError(path_, "concave face with " + std::to_string(corners.size()) +
                                      " corners, expected at most " +
                                      std::to_string(kMaxConcaveCorners));
        }
        const auto first = static_cast<std::uint32_t>(firstVertex_);
        for (const Corners& p : pieces_) {
            soup_.triangles.push_back(
                {first + corners[p[0]], first + corners[p[1]], first + corners[p[2]]});
        }
    }

    const std::filesystem::path& path_;
    Soup& soup_;
    std::size_t firstVertex_;
    std::vector<bool> used_;
    std::vector<Vec3d> points_;
    std::vector<Corners> pieces_;
};

void appendFile(const std::filesystem::path& path, const MeshOptions& options, Soup& soup) {
    const RawMesh raw = readMeshFile(path);
    const std::size_t firstVertex = soup.vertices.size();
    const std::size_t vertices = firstVertex + raw.vertices.size();
    if (vertices > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
        throwFileError(path, std::to_string(vertices) +
                                 " vertices with the files before it, "
                                 "expected at most 2147483647");
    }
    soup.vertices.reserve(vertices);
    for (const Vec3d& v : raw.vertices) soup.vertices.push_back(toWorld(v, options));
    if (!raw.colors.empty()) {
        soup.colors.resize(firstVertex, kUncolored);
        soup.colors.insert(soup.colors.end(), raw.colors.begin(), raw.colors.end());
    } else if (!soup.colors.empty()) {
        soup.colors.resize(vertices, kUncolored);
    }

    FaceCutter cutter(path, soup, firstVertex);
    soup.triangles.reserve(soup.triangles.size() + raw.faceSizes.size());
    std::size_t at = 0;
    for (const std::uint32_t size : raw.faceSizes) {
        cutter.add(std::span(raw.faceVertices).subspan(at, size));
        at += size;
    }
    soup.report.unreferenced += cutter.unreferenced();
}

Vec3d centreOf(const Soup& soup) {
    Box3d box;
    for (const Corners& t : soup.triangles) {
        for (const std::uint32_t corner : t) box.extendBy(soup.vertices[corner]);
    }
    return box.center();
}

/// Whether the triangle has area as the renderer will see it, in float positions.
bool hasArea(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const Vec3d n = (Vec3d(b) - Vec3d(a)).cross(Vec3d(c) - Vec3d(a));
    return n.x != 0.0 || n.y != 0.0 || n.z != 0.0;
}

void dropDegenerate(const Vec3d& origin, Soup& soup) {
    std::vector<char> keep(soup.triangles.size());
    parallelFor(keep.size(), kTrianglesPerChunk, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const auto position = [&](std::size_t corner) {
                return Vec3f(soup.vertices[soup.triangles[i][corner]] - origin);
            };
            keep[i] = hasArea(position(0), position(1), position(2)) ? 1 : 0;
        }
    });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < keep.size(); ++i) {
        if (keep[i]) soup.triangles[kept++] = soup.triangles[i];
    }
    soup.report.degenerate += soup.triangles.size() - kept;
    soup.triangles.resize(kept);
}

/// Keeps the vertices that triangles use, in their order.
TriangleMesh compact(const Vec3d& origin, const Soup& soup) {
    TriangleMesh mesh;
    mesh.origin = origin;
    mesh.report = soup.report;
    mesh.report.triangles = soup.triangles.size();

    constexpr int kUnused = -1;
    std::vector<int> number(soup.vertices.size(), kUnused);
    for (const Corners& t : soup.triangles) {
        for (const std::uint32_t corner : t) number[corner] = 0;
    }
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] == kUnused) continue;
        number[v] = static_cast<int>(mesh.positions.size());
        mesh.positions.emplace_back(soup.vertices[v] - origin);
        if (!soup.colors.empty()) mesh.colors.push_back(soup.colors[v]);
    }
    mesh.triangles.reserve(soup.triangles.size());
    for (const Corners& t : soup.triangles) {
        mesh.triangles.emplace_back(number[t[0]], number[t[1]], number[t[2]]);
    }
    return mesh;
}

std::uint64_t hashPosition(const Vec3f& p) {
    const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value + 0.0f); };
    return hashWords(bits(p.x), bits(p.y), bits(p.z));
}

/// Starts with the corner of the least hash, so that a rotation of the corners changes nothing.
std::uint64_t hashTriangle(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
    if (b < a && b <= c) return hashWords(b, c, a);
    if (c < a && c < b) return hashWords(c, a, b);
    return hashWords(a, b, c);
}

}  // namespace

TriangleMesh loadMesh(std::span<const std::filesystem::path> files, const MeshOptions& options) {
    if (files.empty()) throw Error("no geometry file given, expected at least one");
    if (!(options.scale > 0.0 && std::isfinite(options.scale))) {
        throw Error("scale " + std::to_string(options.scale) + ", expected a number above 0");
    }
    Soup soup;
    for (const auto& path : files) appendFile(path, options, soup);
    const Vec3d origin = soup.triangles.empty() ? Vec3d(0.0) : centreOf(soup);
    dropDegenerate(origin, soup);
    if (soup.triangles.empty()) {
        throwFileError(files.front(), "no triangle left: " + describe(soup.report));
    }
    TriangleMesh mesh = compact(origin, soup);
    soup = {};
    countDefects(mesh);
    return mesh;
}

std::string describe(const MeshReport& report) {
    std::string text = std::to_string(report.triangles) + " triangles";
    const auto add = [&](std::size_t count, const std::string& what) {
        if (count > 0) text += "; " + std::to_string(count) + " " + what;
    };
    add(report.polygons,
        "n-gons cut into " + std::to_string(report.trianglesFromPolygons) + " triangles");
    add(report.badVertexFaces, "dropped for a bad vertex (NaN, Inf or out of range)");
    add(report.degenerate, "without area dropped");
    add(report.duplicates, "duplicates kept");
    add(report.nonManifoldEdges, "non-manifold edges");
    add(report.mixedWinding, "edges of mixed winding");
    add(report.unreferenced, "vertices without a face");
    return text;
}

std::uint64_t fingerprint(const TriangleMesh& mesh) {
    const std::size_t count = mesh.triangles.size();
    std::vector<std::uint64_t> sums(count / kTrianglesPerChunk + 1, 0);
    parallelFor(count, kTrianglesPerChunk, [&](const Chunk& chunk) {
        std::uint64_t sum = 0;
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const auto corner = [&](int k) {
                return hashPosition(mesh.positions[static_cast<std::size_t>(mesh.triangles[i][k])]);
            };
            sum += hashTriangle(corner(0), corner(1), corner(2));
        }
        sums[chunk.index] = sum;
    });
    std::uint64_t total = 0;
    for (const std::uint64_t sum : sums) total += sum;
    const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value + 0.0); };
    return hashWords(total, count,
                     hashWords(bits(mesh.origin.x), bits(mesh.origin.y), bits(mesh.origin.z)));
}

}  // namespace shadowcache
