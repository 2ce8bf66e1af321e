#include "common/import/gltf_mesh.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "common/base/error.h"
#include "common/image/image.h"
#include "common/import/gltf_budget.h"
#include "common/import/gltf_placed_lamps.h"
#include "common/import/gltf_vertices.h"
#include "common/import/local_space.h"
#include "common/import/tangents.h"
#include "common/import/texture_decoder.h"
#include "common/import/texture_islands.h"
#include "common/import/vertex_colors.h"

namespace shadowcache {

namespace {

// Modes of primitives; those below are points and lines.
constexpr int kTriangles = 4, kStrip = 5, kFan = 6;

/// Puts 1 - factor times opacity where a roughness is looked up, and no metalness beside it.
void makeRoughness(float factor, Texture& texture) {
    texture.low = {};
    for (std::size_t i = 0; i + 3 < texture.rgba.size(); i += 4) {
        const float roughness = 255 - factor * static_cast<float>(texture.rgba[i + 3]);
        texture.rgba[i] = texture.rgba[i + 2] = 0;
        texture.rgba[i + 1] = static_cast<std::uint8_t>(std::lround(roughness));
        texture.rgba[i + 3] = 255;
    }
}

/// Builds a RawMesh from primitives: those in the world first, then the groups.
class Builder {
public:
    explicit Builder(const GltfDocument& document) : document_(document), budget_(document) {
        for (const GltfMaterial& m : document.materials)
            out_.materials.emplace_back(m.material).name = m.name;
        out_.textures.resize(document.textures.size());
        used_.assign(document.materials.size(), false);
    }

    void addShape(const GltfShape& shape, int group, const Affine& place) {
        const GltfMesh& mesh = document_.meshes[static_cast<std::size_t>(shape.mesh)];
        for (const GltfPrimitive& p : mesh.primitives)
            if (p.mode < kTriangles)
                ++out_.leftOutOf[{"primitive", "points or lines are left out"}];
            else if (!hasPositions(p))
                ++out_.leftOutOf[{"primitive", "positions are missing (left out)"}];
            else
                addPrimitive(GltfVertices(document_, shape, p, place, budget_), group);
    }

    bool hasPositions(const GltfPrimitive& p) const {
        const auto positions = p.attributes.find("POSITION");
        return positions != p.attributes.end() && document_.accessor(positions->second).count > 0;
    }

    void startGroups() { out_.firstLocalVertex = out_.vertices.size(); }

    void addInstance(int group, const Affine& toWorld) {
        out_.instances.push_back({group, toWorld});
    }

    RawMesh finish(GltfPictures pictures) {
        if (!out_.tangents.empty()) out_.tangents.resize(out_.vertices.size());
        for (std::vector<Vec2f>& more : out_.moreTexcoords)
            more.resize(out_.vertices.size(), Vec2f(0.0f));
        for (std::size_t i = 0; i < used_.size(); ++i) {
            if (!used_[i]) continue;
            out_.blended += out_.materials[i].blends ? 1 : 0;
            for (const std::string& name : document_.materials[i].leftOut) ++out_.leftOut[name];
            if (document_.materials[i].clamped) ++out_.remarks[kClampedMaterials];
            nameIfInvisible(document_.materials[i], out_.leftOutOf);
            if (pictures == GltfPictures::decode) decodePictures(out_.materials[i]);
        }
        bringNearOrigin(out_);
        return std::move(out_);
    }

private:
    void addPrimitive(const GltfVertices& from, int group) {
        std::size_t components = 0;
        const std::vector<double> positions = from.attribute("POSITION", components);
        if (positions.empty() || components != 3)
            from.fail(fmt::format("POSITION of {} components, expected 3", components));
        const std::size_t first = out_.vertices.size(), count = positions.size() / 3;
        for (std::size_t i = 0; i < count; ++i)
            out_.vertices.push_back(from.place(i).point(
                Vec3d(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2])));
        std::vector<float> opacities;
        addNormals(from, first);
        addColors(from, first, opacities);
        const std::size_t firstCorner = out_.faceVertices.size();
        addFaces(from, first);
        addTexcoords(from, first, firstCorner, opacities);
        addTangents(from, first, firstCorner);
        const std::size_t faces = out_.faceSizes.size() - facesDone_;
        facesDone_ = out_.faceSizes.size();
        const int material = from.primitive().material;
        out_.parts.push_back({faces, material, group});
        if (material >= 0) used_[static_cast<std::size_t>(material)] = true;
    }

    void addNormals(const GltfVertices& from, std::size_t first) {
        std::size_t components = 0;
        const std::vector<double> values = from.attribute("NORMAL", components);
        const std::size_t vertices = out_.vertices.size();
        if (values.empty()) {
            if (!out_.normals.empty()) out_.normals.resize(vertices, Vec3d(0.0));
            return;
        }
        if (components != 3 || values.size() != 3 * (vertices - first))
            from.fail("NORMAL does not match the positions, expected one normal for each");
        out_.normals.resize(first, Vec3d(0.0));
        for (std::size_t i = 0; i < values.size(); i += 3)
            out_.normals.push_back(
                from.place(i / 3).normal({values[i], values[i + 1], values[i + 2]}));
    }

    void addColors(const GltfVertices& from, std::size_t first, std::vector<float>& opacities) {
        std::size_t components = 0;
        const std::vector<double> values = from.attribute("COLOR_0", components);
        const std::size_t vertices = out_.vertices.size();
        if (values.empty()) {
            if (!out_.colors.empty()) out_.colors.resize(vertices, kNoColor);
            return;
        }
        if (components < 3 || values.size() != components * (vertices - first))
            from.fail("COLOR_0 does not match the positions, expected one colour for each");
        out_.colors.resize(first, kNoColor);
        for (std::size_t i = 0; i < values.size(); i += components) {
            bool bad = false;
            const auto share = [&](std::size_t k) { return clampedShare(values[i + k], bad); };
            out_.colors.emplace_back(share(0), share(1), share(2));
            if (components == 4) opacities.push_back(share(3));
            out_.badColors += bad ? 1 : 0;
        }
    }

    void addTexcoords(const GltfVertices& from, std::size_t first, std::size_t firstCorner,
                      const std::vector<float>& opacities) {
        const std::size_t vertices = out_.vertices.size();
        const GltfMaterial* material = materialOf(from);
        const bool textured = material && !material->places.empty();
        const bool pierced = material && !opacities.empty() &&
                             (material->material.cutOut || material->material.blends);
        constexpr Vec3f kNone(0, 0, 1);
        if (!textured && !pierced) {
            if (!out_.texcoords.empty()) out_.texcoords.resize(vertices, kNone);
            return;
        }
        out_.texcoords.resize(first, kNone);
        std::vector<Vec2f> places(vertices - first, Vec2f(0.0f));
        const auto textureOf = [&](int number) -> const Texture& {
            return document_.textures[static_cast<std::size_t>(number)].sampler;
        };
        std::vector<Repeats> repeats;
        if (textured) {
            repeats = repeatsOf(*material, textureOf);
            places = texturePlaces(from, first, firstCorner, material->places[0], repeats[0]);
        }
        for (std::size_t i = 0; i < places.size(); ++i)
            out_.texcoords.emplace_back(places[i].x, places[i].y,
                                        opacities.empty() ? 1.0f : opacities[i]);
        for (std::size_t layer = 1; textured && layer < material->places.size(); ++layer) {
            if (out_.moreTexcoords.size() < layer) out_.moreTexcoords.resize(layer);
            std::vector<Vec2f>& more = out_.moreTexcoords[layer - 1];
            more.resize(first, Vec2f(0.0f));
            places =
                texturePlaces(from, first, firstCorner, material->places[layer], repeats[layer]);
            more.insert(more.end(), places.begin(), places.end());
        }
    }

    const GltfMaterial* materialOf(const GltfVertices& from) const {
        const int material = from.primitive().material;
        return material < 0 ? nullptr : &document_.materials[static_cast<std::size_t>(material)];
    }

    /// Texture coordinates of a primitive's vertices, those from `first` on; 0 where it has none.
    std::vector<Vec2f> texturePlaces(const GltfVertices& from, std::size_t first,
                                     std::size_t firstCorner, const GltfTexturePlace& place,
                                     const Repeats& repeats) {
        std::size_t components = 2;
        const std::vector<double> values =
            from.attribute(fmt::format("TEXCOORD_{}", place.texcoordSet), components);
        std::vector<Vec2f> places(out_.vertices.size() - first, Vec2f(0.0f));
        if (values.empty()) {
            ++out_.leftOutOf[{"primitive",
                              "texture coordinates are missing where its material "
                              "has a texture"}];
            return places;
        }
        if (components != 2 || values.size() != 2 * places.size())
            from.fail("texture coordinates do not match the positions, expected a pair for each");
        std::vector<Vec2d> pairs;
        for (std::size_t i = 0; i < values.size(); i += 2)
            pairs.emplace_back(values[i], values[i + 1]);
        const std::vector<std::uint32_t> corners = cornersFrom(first, firstCorner);
        const TextureIslands islands(pairs, corners,
                                     std::vector<std::uint32_t>(corners.size() / 3, 3));
        for (std::size_t i = 0; i < places.size(); ++i) places[i] = islands.at(i, place, repeats);
        return places;
    }

    /// Corners of a primitive, among its vertices.
    std::vector<std::uint32_t> cornersFrom(std::size_t first, std::size_t firstCorner) const {
        std::vector<std::uint32_t> corners(
            out_.faceVertices.begin() + static_cast<std::ptrdiff_t>(firstCorner),
            out_.faceVertices.end());
        for (std::uint32_t& corner : corners)
            if (corner != kNoVertex) corner -= static_cast<std::uint32_t>(first);
        return corners;
    }

    /// The file's, or, where it has none and there is a normal map, some of the texture
    /// coordinates.
    void addTangents(const GltfVertices& from, std::size_t first, std::size_t firstCorner) {
        const std::size_t count = out_.vertices.size() - first;
        const GltfMaterial* material = materialOf(from);
        std::vector<Tangent> tangents;
        if (material && material->material.normal.texture >= 0)
            tangents = tangentsOf(from, first, firstCorner, material->material.normal);
        if (tangents.empty() && out_.tangents.empty()) return;
        out_.tangents.resize(first);
        tangents.resize(count);
        for (std::size_t i = 0; i < count; ++i)
            tangents[i].direction = Vec3f(from.place(i).vector(Vec3d(tangents[i].direction)));
        out_.tangents.insert(out_.tangents.end(), tangents.begin(), tangents.end());
    }

    /// In the mesh's own space, but for their sides, which are the world's.
    std::vector<Tangent> tangentsOf(const GltfVertices& from, std::size_t first,
                                    std::size_t firstCorner, const TextureSlot& slot) const {
        std::size_t components = 0;
        const std::size_t count = out_.vertices.size() - first;
        const std::vector<double> values = from.attribute("TANGENT", components);
        if (!values.empty()) {
            if (components != 4 || values.size() != 4 * count)
                from.fail("TANGENT does not match the positions, expected four numbers for each");
            std::vector<Tangent> tangents;
            for (std::size_t i = 0; i < values.size(); i += 4)
                tangents.push_back(
                    {Vec3f(Vec3d(values[i], values[i + 1], values[i + 2])),
                     (values[i + 3] < 0) != from.place(i / 4).mirrors() ? -1.0f : 1.0f});
            return tangents;
        }
        const std::vector<Vec3d> normals = vectors(from, "NORMAL");
        const std::vector<std::uint32_t> corners = cornersFrom(first, firstCorner);
        // A mirrored mesh has its corners the other way round, and so the sides of the world.
        return deriveTangents(vectors(from, "POSITION"), normals, placesInLayer(first, slot.layer),
                              corners);
    }

    static std::vector<Vec3d> vectors(const GltfVertices& from, const char* name) {
        std::size_t components = 0;
        const std::vector<double> values = from.attribute(name, components);
        std::vector<Vec3d> result;
        for (std::size_t i = 0; i + 2 < values.size(); i += 3)
            result.emplace_back(values[i], values[i + 1], values[i + 2]);
        return result;
    }

    /// Texture coordinates that were added, of vertices from `first` on.
    std::vector<Vec2f> placesInLayer(std::size_t first, int layer) const {
        std::vector<Vec2f> places;
        for (std::size_t i = first; i < out_.vertices.size(); ++i)
            places.push_back(layer == 0
                                 ? Vec2f(out_.texcoords[i].x, out_.texcoords[i].y)
                                 : out_.moreTexcoords[static_cast<std::size_t>(layer - 1)][i]);
        return places;
    }

    void addFaces(const GltfVertices& from, std::size_t first) {
        const GltfPrimitive& p = from.primitive();
        const std::size_t vertices = out_.vertices.size() - first;
        std::vector<std::uint32_t> corners;
        std::string cause;
        if (p.indices >= 0) {
            const GltfAccessor& accessor = document_.accessor(p.indices);
            if (accessor.array.components != 1)
                from.fail(
                    fmt::format("indices of {} components, expected 1", accessor.array.components));
            corners = decodeIndices(accessor, cause);
            if (!cause.empty()) from.fail("indices: " + cause);
        } else {
            corners.resize(vertices);
            for (std::size_t i = 0; i < vertices; ++i) corners[i] = static_cast<std::uint32_t>(i);
        }
        const auto face = [&](std::size_t a, std::size_t b, std::size_t c) {
            if (from.mirrors(corners[a], corners[b], corners[c])) std::swap(b, c);
            for (const std::size_t k : {a, b, c})
                out_.faceVertices.push_back(corners[k] < vertices
                                                ? static_cast<std::uint32_t>(first) + corners[k]
                                                : kNoVertex);
            out_.faceSizes.push_back(3);
        };
        if (corners.size() < 3 || (p.mode == kTriangles && corners.size() % 3 != 0))
            ++out_.leftOutOf[{"primitive", "last corners make no triangle and are left out"}];
        if (p.mode == kTriangles)
            for (std::size_t i = 0; i + 2 < corners.size(); i += 3) face(i, i + 1, i + 2);
        if (p.mode == kStrip)
            for (std::size_t i = 0; i + 2 < corners.size(); ++i)
                face(i, i + 1 + i % 2, i + 2 - i % 2);
        if (p.mode == kFan)
            for (std::size_t i = 0; i + 2 < corners.size(); ++i) face(i + 1, i + 2, 0);
    }

    /// Leaves the textures out whose pictures cannot be read. Without its picture a surface would
    /// shine all over: it does not emit.
    void decodePictures(Material& material) {
        for (int* texture : texturesOf(material)) {
            if (*texture < 0 || decodePicture(*texture)) continue;
            if (texture == &material.finish.emissionTexture.texture)
                material.finish.emission = Rgb(0.0f);
            *texture = -1;
        }
    }

    /// @return whether it could be read
    bool decodePicture(int index) {
        Texture& texture = out_.textures[static_cast<std::size_t>(index)];
        if (!texture.rgba.empty()) return true;
        const GltfTexture& from = document_.textures[static_cast<std::size_t>(index)];
        std::string cause = from.name.empty() ? "in PNG, JPEG or WebP is missing" : "was not found";
        if (!from.encoded.empty()) texture = decodeTexture(from.encoded, cause);
        if (texture.rgba.empty()) {
            nameOne("texture", "picture " + cause + " (left out)",
                    from.name.empty() ? std::to_string(index) : from.name, out_.leftOutOf);
            return false;
        }
        // A picture that several textures show is kept for each.
        if (!decoded_.insert(from.encoded.data()).second)
            budget_.take((texture.rgba.size() + texture.low.size()) / 4);
        if (from.glossiness) makeRoughness(*from.glossiness, texture);
        texture.wrapS = from.sampler.wrapS;
        texture.wrapT = from.sampler.wrapT;
        texture.smooth = from.sampler.smooth;
        return true;
    }

    const GltfDocument& document_;
    GltfBudget budget_;
    std::set<const char*> decoded_;  ///< where the pictures are in the document
    RawMesh out_;
    std::size_t facesDone_ = 0;
    std::vector<bool> used_;  ///< by material
};

}  // namespace

RawMesh gltfMesh(const GltfDocument& document, const GltfPose& pose, bool alwaysShared,
                 GltfPictures pictures) {
    std::vector<int> uses(pose.shapes.size(), 0), group(pose.shapes.size(), 0);
    // What is flattened, as a shadow to the floor, cannot be an instance.
    const auto shared = [&](const GltfPlacement& placement) {
        return alwaysShared || (uses[placement.shape] > 1 && placement.toWorld.invertible());
    };
    for (const GltfPlacement& placement : pose.placements)
        if (placement.toWorld.invertible()) ++uses[placement.shape];
    Builder builder(document);
    for (const GltfPlacement& placement : pose.placements)
        if (!shared(placement))
            builder.addShape(pose.shapes[placement.shape], 0, placement.toWorld);
    builder.startGroups();
    int groups = 0;
    for (const GltfPlacement& placement : pose.placements) {
        if (!shared(placement)) continue;
        int& number = group[placement.shape];
        if (number == 0) {
            number = ++groups;
            builder.addShape(pose.shapes[placement.shape], number, {});
        }
        builder.addInstance(number, placement.toWorld);
    }
    return builder.finish(pictures);
}

RawMesh readGltf(const std::filesystem::path& path, References references,
                 std::optional<double> stillAt) {
    const GltfDocument document = readGltfDocument(path, references);
    const GltfNodes nodes(document);
    std::vector<int> still = nodes.meshNodes(false);
    if (stillAt) {
        const std::vector<int> moving = nodes.meshNodes(true);
        still.insert(still.end(), moving.begin(), moving.end());
        std::sort(still.begin(), still.end());
    }
    RawMesh mesh = gltfMesh(document, poseOf(document, nodes, still, stillAt.value_or(0)), false);
    mesh.leftOutOf.insert(document.leftOutOf.begin(), document.leftOutOf.end());
    mesh.lamps = gltfLamps(document, nodes, stillAt, mesh.leftOutOf);
    if (!stillAt) mesh.moving = nodes.meshNodes(true).size();
    return mesh;
}

}  // namespace shadowcache
