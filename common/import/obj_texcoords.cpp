#include "common/import/obj_texcoords.h"

#include <algorithm>

#include "common/import/tangents.h"

namespace shadowcache {

namespace {

constexpr Vec3f kNoTexcoord{0, 0, 1};

}  // namespace

ObjTexcoords::ObjTexcoords(std::span<const Vec2d> texcoords,
                           std::span<const std::uint32_t> faceTexcoords, RawMesh& mesh)
    : texcoords_(texcoords),
      faceTexcoords_(faceTexcoords),
      islands_(texcoords, faceTexcoords, mesh.faceSizes),
      mesh_(mesh),
      uses_(mesh.vertices.size(), kUnused) {
    // What names no vertex of the file must not name a copy.
    for (std::uint32_t& vertex : mesh.faceVertices)
        if (vertex >= uses_.size()) vertex = kNoVertex;
}

void ObjTexcoords::place(const ObjCorners& corners, const GltfMaterial& material) {
    if (material.places.empty()) return;
    const TextureSlot& slot = material.material.normal;
    const bool bent = slot.texture >= 0 && !mesh_.faceNormals.empty();
    const auto textureOf = [&](int number) -> const Texture& {
        return mesh_.textures[static_cast<std::size_t>(number)];
    };
    const Kind kind{material.places, repeatsOf(material, textureOf),
                    bent ? slot.layer : kNoNormalMap};
    const auto known = std::ranges::find(kinds_, kind);
    const auto number = static_cast<std::uint32_t>(known - kinds_.begin());
    if (known == kinds_.end()) kinds_.push_back(kind);
    std::size_t end = corners.firstCorner;
    for (std::size_t face = corners.firstFace; face < corners.endFace; ++face)
        end += mesh_.faceSizes[face];
    for (std::size_t i = corners.firstCorner; i < end; ++i) {
        std::uint32_t& vertex = mesh_.faceVertices[i];
        if (vertex == kNoVertex) continue;
        const std::uint32_t normal = bent ? mesh_.faceNormals[i] : kNoVertex;
        vertex = vertexFor(vertex, {faceTexcoords_[i], number, normal});
        if (normal >= mesh_.normals.size()) continue;
        if (vertex >= normals_.size()) normals_.resize(mesh_.vertices.size(), Vec3d(0.0));
        normals_[vertex] = mesh_.normals[normal];
    }
    if (bent) addTriangles(corners, bent_[slot.layer]);
}

void ObjTexcoords::finish() {
    if (mesh_.texcoords.empty()) return;
    mesh_.texcoords.resize(mesh_.vertices.size(), kNoTexcoord);
    for (auto& more : mesh_.moreTexcoords) more.resize(mesh_.vertices.size(), Vec2f(0.0f));
    if (!bent_.empty()) addTangents();
}

std::uint32_t ObjTexcoords::vertexFor(std::uint32_t vertex, const Use& use) {
    if (uses_[vertex] == use) return vertex;
    if (uses_[vertex] == kUnused) {
        uses_[vertex] = use;
        write(vertex, use);
        return vertex;
    }
    const auto number = static_cast<std::uint32_t>(mesh_.vertices.size());
    const auto [copy, isNew] = copies_.try_emplace({vertex, use[0], use[1], use[2]}, number);
    if (!isNew) return copy->second;
    mesh_.vertices.push_back(Vec3d(mesh_.vertices[vertex]));
    if (!mesh_.colors.empty()) mesh_.colors.push_back(Rgb(mesh_.colors[vertex]));
    write(number, use);
    return number;
}

void ObjTexcoords::write(std::uint32_t vertex, const Use& use) {
    const bool placed = use[0] < texcoords_.size();
    if (!placed)
        ++mesh_.remarks["vertices without texture coordinates, whose material has a picture"];
    const auto& places = kinds_[use[1]].places;
    const auto& repeats = kinds_[use[1]].repeats;
    const auto at = [&](std::size_t layer) {
        return placed ? islands_.at(use[0], places[layer], repeats[layer])
                      : TextureIslands::none(places[layer]);
    };
    if (vertex >= mesh_.texcoords.size())
        mesh_.texcoords.resize(mesh_.vertices.size(), kNoTexcoord);
    mesh_.texcoords[vertex] = {at(0).x, at(0).y, 1};
    if (mesh_.moreTexcoords.size() + 1 < places.size())
        mesh_.moreTexcoords.resize(places.size() - 1);
    for (std::size_t layer = 1; layer < places.size(); ++layer) {
        std::vector<Vec2f>& more = mesh_.moreTexcoords[layer - 1];
        if (vertex >= more.size()) more.resize(mesh_.vertices.size(), Vec2f(0.0f));
        more[vertex] = at(layer);
    }
}

void ObjTexcoords::addTriangles(const ObjCorners& corners,
                                std::vector<std::uint32_t>& triangles) const {
    std::size_t corner = corners.firstCorner;
    for (std::size_t face = corners.firstFace; face < corners.endFace; ++face) {
        const std::size_t size = mesh_.faceSizes[face];
        const auto* const of = mesh_.faceVertices.data() + corner;
        for (std::size_t k = 2; k < size; ++k)
            triangles.insert(triangles.end(), {of[0], of[k - 1], of[k]});
        corner += size;
    }
}

std::vector<Vec2f> ObjTexcoords::placesIn(int layer) const {
    if (layer > 0) return mesh_.moreTexcoords[static_cast<std::size_t>(layer) - 1];
    std::vector<Vec2f> places;
    places.reserve(mesh_.texcoords.size());
    for (const Vec3f& texcoord : mesh_.texcoords) places.emplace_back(texcoord.x, texcoord.y);
    return places;
}

void ObjTexcoords::addTangents() {
    normals_.resize(mesh_.vertices.size(), Vec3d(0.0));
    mesh_.tangents.resize(mesh_.vertices.size());
    for (const auto& [layer, triangles] : bent_) {
        const std::vector<Tangent> tangents =
            deriveTangents(mesh_.vertices, normals_, placesIn(layer), triangles);
        for (std::size_t v = 0; v < tangents.size(); ++v)
            if (tangents[v].side != 0) mesh_.tangents[v] = tangents[v];
    }
}

}  // namespace shadowcache
