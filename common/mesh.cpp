#include "common/mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "common/error.h"
#include "common/mesh_reader.h"
#include "common/mesh_statistics.h"
#include "common/parallel.h"
#include "common/placed_mesh.h"
#include "common/triangulate.h"

namespace shadowcache {

namespace {

constexpr std::size_t kTrianglesPerChunk = 1 << 16;

/// Coordinates beyond this are dropped: Embree ignores primitives beyond 1.8e18 silently.
constexpr double kMaxCoordinate = 1e18;

using Corners = std::array<std::uint32_t, 3>;

/// Material and group of a run of triangles; group 0 is in the world, others where instances put
/// them.
using PartKey = std::pair<int, int>;

/// Triangles of all files so far, in world space; those of groups other than 0 in their own.
struct Soup {
    std::vector<Vec3d> vertices;
    std::vector<Corners> triangles;
    std::vector<Rgb> colors;
    std::vector<Vec3f> texcoords;
    std::vector<PartKey> parts{{0, -1}};  ///< group, material
    std::vector<std::uint32_t> partOf;    ///< by triangle; empty: all are of part 0
    std::vector<RawInstance> instances;
    std::vector<std::pair<std::size_t, std::size_t>> local;  ///< ranges of the groups' vertices
    std::vector<Material> materials;
    std::vector<Texture> textures;
    int groups = 0;
    MeshReport report;

    bool isLocal(std::size_t vertex) const {
        return std::any_of(local.begin(), local.end(), [&](const auto& range) {
            return vertex >= range.first && vertex < range.second;
        });
    }
    /// As the renderer will see it.
    Vec3f position(std::size_t vertex, const Vec3d& origin) const {
        return Vec3f(isLocal(vertex) ? vertices[vertex] : vertices[vertex] - origin);
    }
};

bool usable(const Vec3d& v) {
    // Written so that NaN fails.
    return std::abs(v.x) <= kMaxCoordinate && std::abs(v.y) <= kMaxCoordinate &&
           std::abs(v.z) <= kMaxCoordinate;
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

/// Brings an attribute of the vertices up to date after a file: `fallback` where it has none.
template <class T>
void appendAttribute(std::size_t firstVertex, std::size_t vertices, const std::vector<T>& from,
                     const T& fallback, std::vector<T>& to) {
    if (!from.empty()) {
        to.resize(firstVertex, fallback);
        to.insert(to.end(), from.begin(), from.end());
    } else if (!to.empty()) {
        to.resize(vertices, fallback);
    }
}

void appendVertices(const std::filesystem::path& path, const RawMesh& raw,
                    const MeshOptions& options, Soup& soup) {
    const std::size_t firstVertex = soup.vertices.size();
    const std::size_t vertices = firstVertex + raw.vertices.size();
    if (vertices > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
        throwFileError(path, std::to_string(vertices) +
                                 " vertices with the files before it, "
                                 "expected at most 2147483647");
    }
    const Affine world = worldOf(options);
    const std::size_t direct = std::min(raw.firstLocalVertex, raw.vertices.size());
    soup.vertices.reserve(vertices);
    for (std::size_t i = 0; i < direct; ++i) soup.vertices.push_back(world.point(raw.vertices[i]));
    for (std::size_t i = direct; i < raw.vertices.size(); ++i)
        soup.vertices.push_back(raw.vertices[i]);
    if (firstVertex + direct < vertices) soup.local.emplace_back(firstVertex + direct, vertices);
    appendAttribute(firstVertex, vertices, raw.colors, kUncolored, soup.colors);
    appendAttribute(firstVertex, vertices, raw.texcoords, Vec3f(0, 0, 1), soup.texcoords);
}

/// Materials, textures and instances of a file, renumbered behind those of the files before.
void appendLooks(RawMesh& raw, const MeshOptions& options, Soup& soup) {
    const Affine world = worldOf(options);
    for (Material material : raw.materials) {
        if (material.texture >= 0) material.texture += static_cast<int>(soup.textures.size());
        soup.materials.push_back(material);
    }
    for (Texture& texture : raw.textures) soup.textures.push_back(std::move(texture));
    int groups = 0;
    for (const RawInstance& instance : raw.instances) {
        groups = std::max(groups, instance.group);
        soup.instances.push_back({instance.group + soup.groups, compose(world, instance.toWorld)});
    }
    soup.groups += groups;
    soup.report.blended += raw.blended;
}

void append(const std::filesystem::path& path, RawMesh raw, const MeshOptions& options,
            Soup& soup) {
    const std::size_t firstVertex = soup.vertices.size();
    const auto firstMaterial = static_cast<int>(soup.materials.size());
    const int firstGroup = soup.groups;
    appendVertices(path, raw, options, soup);
    appendLooks(raw, options, soup);

    FaceCutter cutter(path, soup, firstVertex);
    soup.triangles.reserve(soup.triangles.size() + raw.faceSizes.size());
    std::size_t at = 0, face = 0;
    const auto addFaces = [&](std::size_t count) {
        for (const std::size_t end = face + count; face < end; ++face) {
            const std::uint32_t size = raw.faceSizes[face];
            cutter.add(std::span(raw.faceVertices).subspan(at, size));
            at += size;
        }
    };
    for (const RawPart& part : raw.parts) {
        soup.partOf.resize(soup.triangles.size(), 0);
        addFaces(part.faceCount);
        soup.partOf.resize(soup.triangles.size(), static_cast<std::uint32_t>(soup.parts.size()));
        soup.parts.emplace_back(part.group == 0 ? 0 : part.group + firstGroup,
                                part.material < 0 ? -1 : part.material + firstMaterial);
    }
    addFaces(raw.faceSizes.size() - face);
    if (!soup.partOf.empty()) soup.partOf.resize(soup.triangles.size(), 0);
    soup.report.unreferenced += cutter.unreferenced();
}

Vec3d centreOf(const Soup& soup) {
    std::vector<Box3d> box(static_cast<std::size_t>(soup.groups) + 1);
    for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
        const std::uint32_t part = soup.partOf.empty() ? 0 : soup.partOf[i];
        for (const std::uint32_t corner : soup.triangles[i])
            box[static_cast<std::size_t>(soup.parts[part].first)].extendBy(soup.vertices[corner]);
    }
    for (const RawInstance& instance : soup.instances) {
        const Box3d& group = box[static_cast<std::size_t>(instance.group)];
        if (group.isEmpty()) continue;
        for (int k = 0; k < 8; ++k)
            box[0].extendBy(instance.toWorld.point(Vec3d((k & 1 ? group.min : group.max).x,
                                                         (k & 2 ? group.min : group.max).y,
                                                         (k & 4 ? group.min : group.max).z)));
    }
    return box[0].center();
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
                return soup.position(soup.triangles[i][corner], origin);
            };
            keep[i] = hasArea(position(0), position(1), position(2)) ? 1 : 0;
        }
    });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < keep.size(); ++i) {
        if (!keep[i]) continue;
        if (!soup.partOf.empty()) soup.partOf[kept] = soup.partOf[i];
        soup.triangles[kept++] = soup.triangles[i];
    }
    if (!soup.partOf.empty()) soup.partOf.resize(kept);
    soup.report.degenerate += soup.triangles.size() - kept;
    soup.triangles.resize(kept);
}

/// Sorts the triangles by group and material, and makes the parts of the mesh.
void makeParts(const Vec3d& origin, Soup& soup, TriangleMesh& mesh) {
    if (soup.partOf.empty()) return;
    std::map<PartKey, std::uint32_t> count;
    for (const std::uint32_t part : soup.partOf) ++count[soup.parts[part]];
    std::map<PartKey, std::uint32_t> next;
    std::map<int, MeshInstance> groups;
    std::uint32_t first = 0;
    for (const auto& [key, triangles] : count) {
        MeshInstance& group = groups[key.first];
        if (group.partCount++ == 0) group.firstPart = static_cast<std::uint32_t>(mesh.parts.size());
        group.triangleCount += triangles;
        if (key.first == 0) mesh.firstSharedPart = mesh.parts.size() + 1;
        mesh.parts.push_back({first, triangles, key.second});
        next[key] = first;
        first += triangles;
    }
    std::vector<Corners> sorted(soup.triangles.size());
    for (std::size_t i = 0; i < sorted.size(); ++i)
        sorted[next[soup.parts[soup.partOf[i]]]++] = soup.triangles[i];
    soup.triangles = std::move(sorted);

    std::uint64_t placed = groups[0].triangleCount;
    for (std::size_t i = 0; i < soup.instances.size(); ++i) {
        const RawInstance& raw = soup.instances[i];
        MeshInstance instance = groups[raw.group];
        if (instance.triangleCount == 0) continue;
        instance.source = static_cast<std::uint32_t>(i);
        instance.toWorld = raw.toWorld;
        instance.toWorld.position -= origin;
        instance.firstPlaced = static_cast<std::uint32_t>(placed);
        placed += instance.triangleCount;
        if (placed > std::numeric_limits<std::uint32_t>::max())
            throw Error("more than 4294967295 triangles with all instances, expected fewer");
        mesh.instances.push_back(instance);
    }
}

/// Keeps the vertices that triangles use, in their order.
TriangleMesh compact(const Vec3d& origin, Soup& soup) {
    TriangleMesh mesh;
    mesh.origin = origin;
    makeParts(origin, soup, mesh);
    mesh.materials = std::move(soup.materials);
    mesh.textures = std::move(soup.textures);
    mesh.report = soup.report;
    mesh.report.triangles = soup.triangles.size();
    mesh.report.instances = mesh.instances.size();

    constexpr int kUnused = -1;
    std::vector<int> number(soup.vertices.size(), kUnused);
    for (const Corners& t : soup.triangles) {
        for (const std::uint32_t corner : t) number[corner] = 0;
    }
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] == kUnused) continue;
        number[v] = static_cast<int>(mesh.positions.size());
        mesh.positions.push_back(soup.position(v, origin));
        if (!soup.colors.empty()) mesh.colors.push_back(soup.colors[v]);
        if (!soup.texcoords.empty()) mesh.texcoords.push_back(soup.texcoords[v]);
    }
    mesh.triangles.reserve(soup.triangles.size());
    for (const Corners& t : soup.triangles) {
        mesh.triangles.emplace_back(number[t[0]], number[t[1]], number[t[2]]);
    }
    mesh.report.placed = placedCount(mesh);
    return mesh;
}

/// What all files together make.
TriangleMesh finish(const std::filesystem::path& path, const MeshOptions& options, Soup soup) {
    const Vec3d origin = options.origin           ? *options.origin
                         : soup.triangles.empty() ? Vec3d(0.0)
                                                  : centreOf(soup);
    dropDegenerate(origin, soup);
    if (soup.triangles.empty()) throwFileError(path, "no triangle left: " + describe(soup.report));
    TriangleMesh mesh = compact(origin, soup);
    soup = {};
    countDefects(mesh);
    return mesh;
}

}  // namespace

Affine worldOf(const MeshOptions& options) {
    const double s = options.scale;
    if (options.zUp) return {{Vec3d(s, 0, 0), Vec3d(0, 0, -s), Vec3d(0, s, 0)}, Vec3d(0.0)};
    return {{Vec3d(s, 0, 0), Vec3d(0, s, 0), Vec3d(0, 0, s)}, Vec3d(0.0)};
}

TriangleMesh loadMesh(std::span<const std::filesystem::path> files, const MeshOptions& options) {
    if (files.empty()) throw Error("no geometry file given, expected at least one");
    if (!(options.scale > 0.0 && std::isfinite(options.scale))) {
        throw Error("scale " + std::to_string(options.scale) + ", expected a number above 0");
    }
    Soup soup;
    for (const auto& path : files) append(path, readMeshFile(path), options, soup);
    return finish(files.front(), options, std::move(soup));
}

TriangleMesh assembleMesh(const std::filesystem::path& path, RawMesh raw,
                          const MeshOptions& options) {
    Soup soup;
    append(path, std::move(raw), options, soup);
    return finish(path, options, std::move(soup));
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
    add(report.blended, "blending materials taken as opaque");
    add(report.instances,
        "instances, with which " + std::to_string(report.placed) + " triangles are in the world");
    return text;
}

}  // namespace shadowcache
