#include "common/import/mesh_soup.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "common/base/error.h"
#include "common/import/lamp_place.h"
#include "common/import/triangulate.h"
#include "common/math/limits.h"

namespace shadowcache {

namespace {

/// Cuts faces into triangles, at hand for one file after the other.
class FaceCutter {
public:
    FaceCutter(const std::filesystem::path& path, MeshSoup& soup, std::size_t firstVertex)
        : path_(path), soup_(soup), firstVertex_(firstVertex) {
        used_.assign(soup.vertices.size() - firstVertex, false);
    }

    /// @param normals  numbers of the corners' normals, or empty
    void add(std::span<const std::uint32_t> corners, std::span<const std::uint32_t> normals) {
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
                return corner < used_.size() && isInReach(soup_.vertices[firstVertex_ + corner]);
            })) {
            report.badVertexFaces += triangles;
            return;
        }
        cut(corners, normals);
    }

    std::size_t unreferenced() const {
        return static_cast<std::size_t>(std::count(used_.begin(), used_.end(), false));
    }

private:
    void cut(std::span<const std::uint32_t> corners, std::span<const std::uint32_t> normals) {
        points_.clear();
        pieces_.clear();
        for (const auto corner : corners) points_.push_back(soup_.vertices[firstVertex_ + corner]);
        if (!triangulate(points_, pieces_)) {
            throwFileError(path_, fmt::format("concave face with {} corners, expected at most {}",
                                              corners.size(), kMaxConcaveCorners));
        }
        const auto first = static_cast<std::uint32_t>(firstVertex_);
        for (const Corners& p : pieces_) {
            soup_.triangles.push_back(
                {first + corners[p[0]], first + corners[p[1]], first + corners[p[2]]});
            if (!normals.empty())
                soup_.cornerNormals.push_back({normals[p[0]], normals[p[1]], normals[p[2]]});
        }
    }

    const std::filesystem::path& path_;
    MeshSoup& soup_;
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
                    const MeshOptions& options, MeshSoup& soup) {
    const std::size_t firstVertex = soup.vertices.size();
    const std::size_t vertices = firstVertex + raw.vertices.size();
    if (vertices > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
        throwFileError(
            path, fmt::format("{} vertices with the files before it, expected at most 2147483647",
                              vertices));
    }
    const Affine world = worldOf(options);
    const std::size_t direct = std::min(raw.firstLocalVertex, raw.vertices.size());
    soup.vertices.reserve(vertices);
    for (std::size_t i = 0; i < direct; ++i) soup.vertices.push_back(world.point(raw.vertices[i]));
    for (std::size_t i = direct; i < raw.vertices.size(); ++i)
        soup.vertices.push_back(raw.vertices[i]);
    if (firstVertex + direct < vertices) soup.local.emplace_back(firstVertex + direct, vertices);
    appendAttribute(firstVertex, vertices, raw.colors, kNoColor, soup.colors);
    appendAttribute(firstVertex, vertices, raw.texcoords, Vec3f(0, 0, 1), soup.texcoords);
    soup.moreTexcoords.resize(std::max(soup.moreTexcoords.size(), raw.moreTexcoords.size()));
    static const std::vector<Vec2f> kNone;
    for (std::size_t k = 0; k < soup.moreTexcoords.size(); ++k)
        appendAttribute(firstVertex, vertices,
                        k < raw.moreTexcoords.size() ? raw.moreTexcoords[k] : kNone, Vec2f(0.0f),
                        soup.moreTexcoords[k]);
}

/// Appends a file's tangents, and makes them unit vectors.
void appendTangents(const RawMesh& raw, const MeshOptions& options, MeshSoup& soup) {
    const Affine world = worldOf(options);
    const std::size_t first = soup.vertices.size() - raw.vertices.size();
    std::vector<Tangent> tangents = raw.tangents;
    for (std::size_t i = 0; i < tangents.size(); ++i) {
        Tangent& tangent = tangents[i];
        const Vec3d direction(tangent.direction);
        const Vec3d unit =
            (i < raw.firstLocalVertex ? world.vector(direction) : direction).normalized();
        tangent.direction = Vec3f(unit);
        if (!(unit.length2() > 0.5)) tangent = {};
    }
    appendAttribute(first, soup.vertices.size(), tangents, Tangent{}, soup.tangents);
}

/// Appends a file's shading normals, and makes them unit vectors.
///
/// @return  number in the soup of each of raw.faceVertices' normals, kNoVertex for none; empty if
/// the file has no normals
std::vector<std::uint32_t> appendNormals(const RawMesh& raw, const MeshOptions& options,
                                         MeshSoup& soup) {
    if (!options.shadingNormals || raw.normals.empty()) return {};
    const Affine world = worldOf(options);
    std::vector<std::uint32_t> number(raw.normals.size(), kNoVertex);
    for (std::size_t i = 0; i < raw.normals.size(); ++i) {
        const bool local = raw.faceNormals.empty() && i >= raw.firstLocalVertex;
        const Vec3d& n = raw.normals[i];
        const double length = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
        if (!(length > 0 && std::isfinite(n.x + n.y + n.z))) {
            ++soup.report.badNormals;
            continue;
        }
        number[i] = static_cast<std::uint32_t>(soup.normals.size());
        const Vec3d unit = n / length;  // neither overflows nor vanishes when it is squared
        soup.normals.emplace_back((local ? unit : world.normal(unit)).normalized());
    }
    std::vector<std::uint32_t> corners;
    corners.reserve(raw.faceVertices.size());
    for (const std::uint32_t i : raw.faceNormals.empty() ? raw.faceVertices : raw.faceNormals) {
        corners.push_back(i < number.size() ? number[i] : kNoVertex);
        soup.report.badNormals += i >= number.size() && i != kNoVertex ? 1 : 0;
    }
    return corners;
}

void appendLamps(const std::filesystem::path& path, const RawMesh& raw, const MeshOptions& options,
                 MeshSoup& soup) {
    if (!options.lamps) return;
    for (const Lamp& lamp : raw.lamps) soup.lamps.push_back(lampOfSet(path, lamp, options));
}

/// Nothing, but of a pane its glass.
Finish withoutGloss(const Material& material) {
    if (!material.isPane()) return {};
    Finish finish = material.finish;
    finish.emission = Rgb(0.0f);
    finish.emissionTexture = {};
    return finish;
}

/// Materials, textures and instances of a file, renumbered behind those of the files before.
void appendLooks(RawMesh& raw, const MeshOptions& options, MeshSoup& soup) {
    const Affine world = worldOf(options);
    std::vector<bool> used(raw.textures.size(), false);
    for (Material material : raw.materials) {
        if (!options.gloss) material.finish = withoutGloss(material);
        if (!options.lamps) {
            material.finish.emission = Rgb(0.0f);
            material.finish.emissionTexture = {};
        }
        material.finish.gain = lampGainOf(material.name, options.gains);
        if (!options.shadingNormals) material.normal = {};
        for (int* texture : texturesOf(material)) {
            if (*texture < 0) continue;
            used[static_cast<std::size_t>(*texture)] = true;
            *texture += static_cast<int>(soup.textures.size());
        }
        soup.materials.push_back(material);
    }
    for (std::size_t i = 0; i < used.size(); ++i) {
        if (used[i]) continue;
        raw.textures[i].rgba = std::vector<std::uint8_t>();  // {} would keep the memory
        raw.textures[i].low = std::vector<std::uint8_t>();
    }
    for (Texture& texture : raw.textures) soup.textures.push_back(std::move(texture));
    int groups = 0;
    for (const RawInstance& instance : raw.instances) {
        groups = std::max(groups, instance.group);
        soup.instances.push_back({instance.group + soup.groups, compose(world, instance.toWorld)});
    }
    soup.groups += groups;
    soup.moving += raw.moving;
    soup.report.badColors += raw.badColors;
    for (const auto& [remark, count] : raw.remarks) soup.report.remarks[remark] += count;
    soup.report.blended += raw.blended;
    for (const auto& [name, count] : raw.leftOut) soup.report.leftOut[name] += count;
    for (const auto& [thing, count] : raw.leftOutOf) soup.report.leftOutOf[thing] += count;
}

}  // namespace

Vec3f MeshSoup::position(std::size_t vertex, const Vec3d& origin) const {
    const bool isLocal = std::any_of(local.begin(), local.end(), [&](const auto& range) {
        return vertex >= range.first && vertex < range.second;
    });
    return Vec3f(isLocal ? vertices[vertex] : vertices[vertex] - origin);
}

void append(const std::filesystem::path& path, RawMesh raw, const MeshOptions& options,
            MeshSoup& soup) {
    const std::size_t firstVertex = soup.vertices.size();
    const auto firstMaterial = static_cast<int>(soup.materials.size());
    const int firstGroup = soup.groups;
    appendVertices(path, raw, options, soup);
    if (options.shadingNormals) appendTangents(raw, options, soup);
    const std::vector<std::uint32_t> normals = appendNormals(raw, options, soup);
    constexpr Corners kNoNormals{kNoVertex, kNoVertex, kNoVertex};
    if (!normals.empty()) soup.cornerNormals.resize(soup.triangles.size(), kNoNormals);
    appendLooks(raw, options, soup);
    appendLamps(path, raw, options, soup);

    FaceCutter cutter(path, soup, firstVertex);
    soup.triangles.reserve(soup.triangles.size() + raw.faceSizes.size());
    std::size_t at = 0, face = 0;
    const auto addFaces = [&](std::size_t count) {
        for (const std::size_t end = face + count; face < end; ++face) {
            const std::uint32_t size = raw.faceSizes[face];
            cutter.add(std::span(raw.faceVertices).subspan(at, size),
                       normals.empty() ? std::span<const std::uint32_t>()
                                       : std::span(normals).subspan(at, size));
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
    if (!soup.cornerNormals.empty()) soup.cornerNormals.resize(soup.triangles.size(), kNoNormals);
    soup.report.unreferenced += cutter.unreferenced();
}

}  // namespace shadowcache
