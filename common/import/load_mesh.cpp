#include "common/import/load_mesh.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "common/base/error.h"
#include "common/base/interrupt.h"
#include "common/base/parallel.h"
#include "common/import/blurred.h"
#include "common/import/mesh_reader.h"
#include "common/import/mesh_soup.h"
#include "common/mesh/mesh_statistics.h"
#include "common/mesh/placed_mesh.h"
#include "common/mesh/smooth_normals.h"
#include "common/mesh/traceable.h"

namespace shadowcache {

namespace {

constexpr std::size_t kTrianglesPerChunk = 1 << 16;

/// Whether a triangle is none, but for rounding: it is dropped, and must not move the origin.
bool isFlat(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    constexpr double kRounding = 1e-12;
    const Vec3d ab = b - a, ac = c - a;
    return !(ab.cross(ac).length() > kRounding * ab.length() * ac.length());
}

Vec3d centreOf(const MeshSoup& soup) {
    std::vector<Box3d> box(static_cast<std::size_t>(soup.groups) + 1);
    for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
        const auto corner = [&](std::size_t k) { return soup.vertices[soup.triangles[i][k]]; };
        if (isFlat(corner(0), corner(1), corner(2))) continue;
        for (std::size_t k = 0; k < 3; ++k)
            box[static_cast<std::size_t>(soup.groupOf(i))].extendBy(corner(k));
    }
    for (const RawInstance& instance : soup.instances) {
        const Box3d& group = box[static_cast<std::size_t>(instance.group)];
        if (group.isEmpty()) continue;
        for (int k = 0; k < 8; ++k)
            box[0].extendBy(instance.toWorld.point(Vec3d((k & 1 ? group.min : group.max).x,
                                                         (k & 2 ? group.min : group.max).y,
                                                         (k & 4 ? group.min : group.max).z)));
    }
    return box[0].isEmpty() ? Vec3d(0.0) : box[0].center();
}

/// Whether the triangle has area as the renderer will see it, in float positions.
bool hasArea(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const Vec3d n = (Vec3d(b) - Vec3d(a)).cross(Vec3d(c) - Vec3d(a));
    return n.x != 0.0 || n.y != 0.0 || n.z != 0.0;
}

void dropDegenerate(const Vec3d& origin, MeshSoup& soup) {
    std::vector<char> keep(soup.triangles.size());
    parallelFor(keep.size(), kTrianglesPerChunk, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const Corners& t = soup.triangles[i];
            const auto position = [&](std::size_t k) { return soup.position(t[k], origin); };
            const bool flat = isFlat(soup.vertices[t[0]], soup.vertices[t[1]], soup.vertices[t[2]]);
            keep[i] = !flat && hasArea(position(0), position(1), position(2)) ? 1 : 0;
        }
    });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < keep.size(); ++i) {
        if (!keep[i]) continue;
        if (!soup.partOf.empty()) soup.partOf[kept] = soup.partOf[i];
        if (!soup.cornerNormals.empty()) soup.cornerNormals[kept] = soup.cornerNormals[i];
        soup.triangles[kept++] = soup.triangles[i];
    }
    if (!soup.partOf.empty()) soup.partOf.resize(kept);
    if (!soup.cornerNormals.empty()) soup.cornerNormals.resize(kept);
    soup.report.degenerate += soup.triangles.size() - kept;
    soup.triangles.resize(kept);
}

/// Sorts the triangles by group and material, and makes the parts of the mesh.
void makeParts(const Vec3d& origin, MeshSoup& soup, TriangleMesh& mesh) {
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
    std::vector<Corners> sorted(soup.triangles.size()), normals(soup.cornerNormals.size());
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        const std::uint32_t place = next[soup.parts[soup.partOf[i]]]++;
        sorted[place] = soup.triangles[i];
        if (!normals.empty()) normals[place] = soup.cornerNormals[i];
    }
    soup.triangles = std::move(sorted);
    soup.cornerNormals = std::move(normals);

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

/// The shading normals that corners use, in their order.
void compactNormals(MeshSoup& soup, TriangleMesh& mesh) {
    std::vector<int> number(soup.normals.size(), -1);
    mesh.cornerNormals.reserve(soup.cornerNormals.size());
    for (const Corners& corners : soup.cornerNormals) {
        Vec3i& kept = mesh.cornerNormals.emplace_back(-1, -1, -1);
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t normal = corners[static_cast<std::size_t>(k)];
            if (normal == kNoVertex) continue;
            if (number[normal] < 0) {
                number[normal] = static_cast<int>(mesh.normals.size());
                mesh.normals.push_back(soup.normals[normal]);
            }
            kept[k] = number[normal];
        }
    }
}

/// Keeps the vertices that triangles use, in their order.
TriangleMesh compact(const Vec3d& origin, MeshSoup& soup) {
    TriangleMesh mesh;
    mesh.origin = origin;
    makeParts(origin, soup, mesh);
    mesh.materials = std::move(soup.materials);
    mesh.textures = std::move(soup.textures);
    mesh.lamps = std::move(soup.lamps);
    for (Lamp& lamp : mesh.lamps) lamp.position -= origin;
    mesh.report = soup.report;
    mesh.report.triangles = soup.triangles.size();
    mesh.report.instances = mesh.instances.size();

    constexpr int kUnused = -1;
    std::vector<int> number(soup.vertices.size(), kUnused);
    mesh.moreTexcoords.resize(soup.moreTexcoords.size());
    for (const Corners& t : soup.triangles) {
        for (const std::uint32_t corner : t) number[corner] = 0;
    }
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] == kUnused) continue;
        number[v] = static_cast<int>(mesh.positions.size());
        mesh.positions.push_back(soup.position(v, origin));
        if (!soup.colors.empty()) mesh.colors.push_back(soup.colors[v]);
        if (!soup.texcoords.empty()) mesh.texcoords.push_back(soup.texcoords[v]);
        if (!soup.tangents.empty()) mesh.tangents.push_back(soup.tangents[v]);
        for (std::size_t k = 0; k < soup.moreTexcoords.size(); ++k)
            if (!soup.moreTexcoords[k].empty())
                mesh.moreTexcoords[k].push_back(soup.moreTexcoords[k][v]);
    }
    mesh.triangles.reserve(soup.triangles.size());
    for (const Corners& t : soup.triangles) {
        mesh.triangles.emplace_back(number[t[0]], number[t[1]], number[t[2]]);
    }
    compactNormals(soup, mesh);
    mesh.report.placed = placedCount(mesh);
    return mesh;
}

/// Leaves out what is too small to be seen.
void dropTiny(MeshSoup& soup) {
    const std::size_t dropped = std::erase_if(
        soup.instances, [](const RawInstance& instance) { return isTooSmall(instance.toWorld); });
    if (dropped > 0)
        soup.report.leftOutOf[{"instance", "scale is below 2e-6 (left out)"}] += dropped;
}

/// What all files together make; nothing where no triangle is left.
std::optional<TriangleMesh> finishIfAny(const std::filesystem::path& path,
                                        const MeshOptions& options, MeshSoup& soup) {
    dropTiny(soup);
    const Vec3d origin = options.origin           ? *options.origin
                         : soup.triangles.empty() ? Vec3d(0.0)
                                                  : centreOf(soup);
    countBlurred(origin, soup);
    dropDegenerate(origin, soup);
    if (soup.triangles.empty()) return std::nullopt;
    throwIfInterrupted();
    TriangleMesh mesh = compact(origin, soup);
    if (mesh.report.placed == 0) return std::nullopt;
    soup = {};
    throwIfInterrupted();
    requireTraceable(mesh, path.string());
    countDefects(mesh);
    if (options.smoothDegrees > 0) smoothNormals(mesh, options.smoothDegrees);
    return mesh;
}

TriangleMesh finish(const std::filesystem::path& path, const MeshOptions& options, MeshSoup soup) {
    std::optional<TriangleMesh> mesh = finishIfAny(path, options, soup);
    if (mesh) return *std::move(mesh);
    if (soup.moving > 0 && soup.report.facesRead == 0)
        throwFileError(
            path,
            fmt::format(
                "everything moves: all nodes with a mesh, {}, are animated; expected something "
                "that stands still, to which --dynamic adds this file, or --set-frame",
                soup.moving));
    if (soup.report.facesRead == 0)
        throwFileError(path, "has no face (points, lines or an empty scene), expected triangles");
    const std::string scaled =
        options.scale != 1 ? fmt::format("; with --scale {:g}", options.scale) : "";
    throwFileError(path, fmt::format("no triangle left: {}{}", describe(soup.report), scaled));
}

}  // namespace

TriangleMesh loadMesh(std::span<const std::filesystem::path> files, const MeshOptions& options) {
    if (files.empty()) throw Error("no geometry file given, expected at least one");
    requireScale(options.scale);
    MeshSoup soup;
    for (const auto& path : files) {
        throwIfInterrupted();
        append(path, readMeshFile(path, options.references, options.stillAt), options, soup);
    }
    return finish(files.front(), options, std::move(soup));
}

TriangleMesh assembleMesh(const std::filesystem::path& path, RawMesh raw,
                          const MeshOptions& options) {
    MeshSoup soup;
    append(path, std::move(raw), options, soup);
    return finish(path, options, std::move(soup));
}

std::optional<TriangleMesh> assembleIfAny(const std::filesystem::path& path, RawMesh raw,
                                          const MeshOptions& options) {
    MeshSoup soup;
    append(path, std::move(raw), options, soup);
    return finishIfAny(path, options, soup);
}

}  // namespace shadowcache
