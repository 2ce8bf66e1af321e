#include "common/import/gltf_mesh.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "common/base/error.h"
#include "common/image/image.h"
#include "common/import/gltf_budget.h"
#include "common/import/gltf_nodes.h"
#include "common/import/tangents.h"
#include "common/import/texture_decoder.h"
#include "common/import/vertex_colors.h"

namespace shadowcache {

namespace {

// Modes of primitives; those below are points and lines.
constexpr int kTriangles = 4, kStrip = 5, kFan = 6;

/// Builds a RawMesh from primitives: those in the world first, then the groups.
class Builder {
public:
    explicit Builder(const GltfDocument& document) : document_(document), budget_(document) {
        for (const GltfMaterial& m : document.materials) out_.materials.push_back(m.material);
        out_.textures.resize(document.textures.size());
        used_.assign(document.materials.size(), false);
    }

    void addMesh(int mesh, int group, const Affine& place) {
        for (const GltfPrimitive& p : document_.meshes[static_cast<std::size_t>(mesh)].primitives)
            if (p.mode >= kTriangles) addPrimitive(mesh, p, group, place);
    }

    void startGroups() { out_.firstLocalVertex = out_.vertices.size(); }

    void addInstance(int group, const Affine& toWorld) {
        out_.instances.push_back({group, toWorld});
    }

    RawMesh finish() {
        if (!out_.tangents.empty()) out_.tangents.resize(out_.vertices.size());
        for (std::vector<Vec2f>& more : out_.moreTexcoords)
            more.resize(out_.vertices.size(), Vec2f(0.0f));
        for (std::size_t i = 0; i < used_.size(); ++i) {
            if (!used_[i]) continue;
            out_.blended += out_.materials[i].blends ? 1 : 0;
            for (const std::string& name : document_.materials[i].leftOut) ++out_.leftOut[name];
            for (const int* texture : texturesOf(out_.materials[i]))
                if (*texture >= 0) decodePicture(*texture);
        }
        return std::move(out_);
    }

private:
    [[noreturn]] void fail(int mesh, const std::string& cause) const {
        const std::string& name = document_.meshes[static_cast<std::size_t>(mesh)].name;
        throwFileError(document_.path, "mesh " + std::to_string(mesh) +
                                           (name.empty() ? "" : " (" + name + ")") + ": " + cause);
    }

    /// An attribute's numbers; empty if the primitive has none.
    std::vector<double> attribute(int mesh, const GltfPrimitive& p, const std::string& name,
                                  std::size_t& components) const {
        const auto found = p.attributes.find(name);
        if (found == p.attributes.end()) return {};
        const GltfAccessor& accessor = document_.accessor(found->second);
        components = accessor.array.components;
        std::string cause;
        std::vector<double> values = decode(accessor, cause);
        if (!cause.empty()) fail(mesh, name + ": " + cause);
        return values;
    }

    /// For the vertices of a primitive, counted where it says most, and its corners.
    void takeBudget(const GltfPrimitive& p) {
        std::size_t vertices = 0;
        for (const auto& [name, index] : p.attributes)
            vertices = std::max(vertices, document_.accessor(index).count);
        budget_.take(vertices);
        budget_.take(p.indices >= 0 ? document_.accessor(p.indices).count : vertices);
    }

    void addPrimitive(int mesh, const GltfPrimitive& p, int group, const Affine& place) {
        takeBudget(p);
        std::size_t components = 0;
        const std::vector<double> positions = attribute(mesh, p, "POSITION", components);
        if (positions.empty() || components != 3)
            fail(mesh, "POSITION of " + std::to_string(components) + " components, expected 3");
        const std::size_t first = out_.vertices.size(), count = positions.size() / 3;
        for (std::size_t i = 0; i < count; ++i)
            out_.vertices.push_back(
                place.point(Vec3d(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2])));
        std::vector<float> opacities;
        addNormals(mesh, p, first, place);
        addColors(mesh, p, first, opacities);
        addTexcoords(mesh, p, first, opacities);
        const std::size_t firstCorner = out_.faceVertices.size();
        addFaces(mesh, p, first, count, place.mirrors());
        addTangents(mesh, p, first, firstCorner, place);
        const std::size_t faces = out_.faceSizes.size() - facesDone_;
        facesDone_ = out_.faceSizes.size();
        out_.parts.push_back({faces, p.material, group});
        if (p.material >= 0) used_[static_cast<std::size_t>(p.material)] = true;
    }

    void addNormals(int mesh, const GltfPrimitive& p, std::size_t first, const Affine& place) {
        std::size_t components = 0;
        const std::vector<double> values = attribute(mesh, p, "NORMAL", components);
        const std::size_t vertices = out_.vertices.size();
        if (values.empty()) {
            if (!out_.normals.empty()) out_.normals.resize(vertices, Vec3d(0.0));
            return;
        }
        if (components != 3 || values.size() != 3 * (vertices - first))
            fail(mesh, "NORMAL does not match the positions, expected one normal for each");
        out_.normals.resize(first, Vec3d(0.0));
        for (std::size_t i = 0; i < values.size(); i += 3)
            out_.normals.push_back(place.normal({values[i], values[i + 1], values[i + 2]}));
    }

    void addColors(int mesh, const GltfPrimitive& p, std::size_t first,
                   std::vector<float>& opacities) {
        std::size_t components = 0;
        const std::vector<double> values = attribute(mesh, p, "COLOR_0", components);
        const std::size_t vertices = out_.vertices.size();
        if (values.empty()) {
            if (!out_.colors.empty()) out_.colors.resize(vertices, kUncolored);
            return;
        }
        if (components < 3 || values.size() != components * (vertices - first))
            fail(mesh, "COLOR_0 does not match the positions, expected one colour for each");
        out_.colors.resize(first, kUncolored);
        for (std::size_t i = 0; i < values.size(); i += components) {
            bool bad = false;
            const auto share = [&](std::size_t k) { return clampedShare(values[i + k], bad); };
            out_.colors.emplace_back(share(0), share(1), share(2));
            if (components == 4) opacities.push_back(share(3));
            out_.badColors += bad ? 1 : 0;
        }
    }

    void addTexcoords(int mesh, const GltfPrimitive& p, std::size_t first,
                      const std::vector<float>& opacities) {
        const std::size_t vertices = out_.vertices.size();
        const GltfMaterial* material =
            p.material < 0 ? nullptr : &document_.materials[static_cast<std::size_t>(p.material)];
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
        if (textured) places = texturePlaces(mesh, p, first, material->places.front());
        for (std::size_t i = 0; i < places.size(); ++i)
            out_.texcoords.emplace_back(places[i].x, places[i].y,
                                        opacities.empty() ? 1.0f : opacities[i]);
        for (std::size_t layer = 1; textured && layer < material->places.size(); ++layer) {
            if (out_.moreTexcoords.size() < layer) out_.moreTexcoords.resize(layer);
            std::vector<Vec2f>& more = out_.moreTexcoords[layer - 1];
            more.resize(first, Vec2f(0.0f));
            places = texturePlaces(mesh, p, first, material->places[layer]);
            more.insert(more.end(), places.begin(), places.end());
        }
    }

    /// Texture coordinates of a primitive's vertices, those from `first` on; 0 where it has none.
    std::vector<Vec2f> texturePlaces(int mesh, const GltfPrimitive& p, std::size_t first,
                                     const GltfTexturePlace& place) const {
        std::size_t components = 2;
        const std::vector<double> values =
            attribute(mesh, p, "TEXCOORD_" + std::to_string(place.texcoordSet), components);
        std::vector<Vec2f> places(out_.vertices.size() - first, Vec2f(0.0f));
        if (values.empty()) return places;
        if (components != 2 || values.size() != 2 * places.size())
            fail(mesh, "texture coordinates do not match the positions, expected a pair for each");
        for (std::size_t i = 0; i < places.size(); ++i) {
            const Vec3f uv1(static_cast<float>(values[2 * i]),
                            static_cast<float>(values[2 * i + 1]), 1.0f);
            places[i] = {place.toS.dot(uv1), place.toT.dot(uv1)};
        }
        return places;
    }

    /// The file's, or, where it has none and there is a normal map, some of the texture
    /// coordinates.
    void addTangents(int mesh, const GltfPrimitive& p, std::size_t first, std::size_t firstCorner,
                     const Affine& place) {
        const std::size_t count = out_.vertices.size() - first;
        const GltfMaterial* material =
            p.material < 0 ? nullptr : &document_.materials[static_cast<std::size_t>(p.material)];
        std::vector<Tangent> tangents;
        if (material && material->material.normal.texture >= 0)
            tangents = tangentsOf(mesh, p, first, firstCorner, material->material.normal, place);
        if (tangents.empty() && out_.tangents.empty()) return;
        out_.tangents.resize(first);
        tangents.resize(count);
        for (Tangent& tangent : tangents)
            tangent.direction = Vec3f(place.vector(Vec3d(tangent.direction)));
        out_.tangents.insert(out_.tangents.end(), tangents.begin(), tangents.end());
    }

    /// In the mesh's own space, but for their sides, which are the world's.
    std::vector<Tangent> tangentsOf(int mesh, const GltfPrimitive& p, std::size_t first,
                                    std::size_t firstCorner, const TextureSlot& slot,
                                    const Affine& place) const {
        std::size_t components = 0;
        const std::size_t count = out_.vertices.size() - first;
        const std::vector<double> values = attribute(mesh, p, "TANGENT", components);
        if (!values.empty()) {
            if (components != 4 || values.size() != 4 * count)
                fail(mesh, "TANGENT does not match the positions, expected four numbers for each");
            std::vector<Tangent> tangents;
            for (std::size_t i = 0; i < values.size(); i += 4)
                tangents.push_back({Vec3f(Vec3d(values[i], values[i + 1], values[i + 2])),
                                    (values[i + 3] < 0) != place.mirrors() ? -1.0f : 1.0f});
            return tangents;
        }
        const std::vector<Vec3d> normals = vectors(mesh, p, "NORMAL");
        std::vector<std::uint32_t> corners(
            out_.faceVertices.begin() + static_cast<std::ptrdiff_t>(firstCorner),
            out_.faceVertices.end());
        for (std::uint32_t& corner : corners) corner -= static_cast<std::uint32_t>(first);
        // A mirrored mesh has its corners the other way round, and so the sides of the world.
        return deriveTangents(vectors(mesh, p, "POSITION"), normals,
                              placesInLayer(first, slot.layer), corners);
    }

    std::vector<Vec3d> vectors(int mesh, const GltfPrimitive& p, const char* name) const {
        std::size_t components = 0;
        const std::vector<double> values = attribute(mesh, p, name, components);
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

    void addFaces(int mesh, const GltfPrimitive& p, std::size_t first, std::size_t vertices,
                  bool mirrored) {
        std::vector<std::uint32_t> corners;
        std::string cause;
        if (p.indices >= 0) {
            const GltfAccessor& accessor = document_.accessor(p.indices);
            if (accessor.array.components != 1)
                fail(mesh, "indices of " + std::to_string(accessor.array.components) +
                               " components, expected 1");
            corners = decodeIndices(accessor, cause);
            if (!cause.empty()) fail(mesh, "indices: " + cause);
        } else {
            corners.resize(vertices);
            for (std::size_t i = 0; i < vertices; ++i) corners[i] = static_cast<std::uint32_t>(i);
        }
        const auto face = [&](std::size_t a, std::size_t b, std::size_t c) {
            if (mirrored) std::swap(b, c);
            for (const std::size_t k : {a, b, c})
                out_.faceVertices.push_back(corners[k] < vertices
                                                ? static_cast<std::uint32_t>(first) + corners[k]
                                                : kNoVertex);
            out_.faceSizes.push_back(3);
        };
        if (p.mode == kTriangles)
            for (std::size_t i = 0; i + 2 < corners.size(); i += 3) face(i, i + 1, i + 2);
        if (p.mode == kStrip)
            for (std::size_t i = 0; i + 2 < corners.size(); ++i)
                face(i, i + 1 + i % 2, i + 2 - i % 2);
        if (p.mode == kFan)
            for (std::size_t i = 0; i + 2 < corners.size(); ++i) face(i + 1, i + 2, 0);
    }

    void decodePicture(int index) {
        Texture& texture = out_.textures[static_cast<std::size_t>(index)];
        if (!texture.rgba.empty()) return;
        const GltfTexture& from = document_.textures[static_cast<std::size_t>(index)];
        if (from.encoded.empty())
            throwFileError(document_.path, from.name.empty()
                                               ? "texture " + std::to_string(index) +
                                                     " has no image in PNG, JPEG or WebP"
                                               : from.name + " was not found");
        std::string cause;
        texture = decodeTexture(from.encoded, cause);
        if (texture.rgba.empty())
            throwFileError(document_.path,
                           from.name + ": " + cause + ", expected PNG, JPEG or WebP");
        // A picture that several textures show is kept for each.
        if (!decoded_.insert(from.encoded.data()).second)
            budget_.take((texture.rgba.size() + texture.low.size()) / 4);
        texture.wrapS = from.sampler.wrapS;
        texture.wrapT = from.sampler.wrapT;
        texture.smooth = from.sampler.smooth;
    }

    const GltfDocument& document_;
    GltfBudget budget_;
    std::set<const char*> decoded_;  ///< where the pictures are in the document
    RawMesh out_;
    std::size_t facesDone_ = 0;
    std::vector<bool> used_;  ///< by material
};

void requireRigid(const GltfDocument& document, const GltfNode& node) {
    const auto refuse = [&](const std::string& what, const std::string& advice) {
        throwFileError(document.path,
                       "node " + node.name + ": " + what + " is not supported; " + advice);
    };
    if (node.skinned) refuse("an armature", "apply it before the export");
    if (document.meshes[static_cast<std::size_t>(node.mesh)].morphs)
        refuse("a morph target (shape key)", "apply it before the export");
}

void requireNoAnimatedShapes(const GltfDocument& document) {
    for (const GltfAnimation& animation : document.animations)
        for (const GltfChannel& channel : animation.channels)
            if (channel.path == GltfChannel::Path::weights)
                throwFileError(document.path, "animation " + animation.name +
                                                  ": moves a shape key; only nodes may move");
}

}  // namespace

RawMesh gltfMesh(const GltfDocument& document, std::span<const GltfPlacement> nodes,
                 bool alwaysShared) {
    std::vector<int> uses(document.meshes.size(), 0), group(document.meshes.size(), 0);
    const auto meshOf = [&](const GltfPlacement& placement) {
        return static_cast<std::size_t>(
            document.nodes[static_cast<std::size_t>(placement.node)].mesh);
    };
    // What is flattened, as a shadow to the floor, cannot be an instance.
    const auto shared = [&](const GltfPlacement& placement) {
        return alwaysShared || (uses[meshOf(placement)] > 1 && placement.toWorld.invertible());
    };
    for (const GltfPlacement& placement : nodes) {
        requireRigid(document, document.nodes[static_cast<std::size_t>(placement.node)]);
        if (placement.toWorld.invertible()) ++uses[meshOf(placement)];
    }
    requireNoAnimatedShapes(document);
    Builder builder(document);
    for (const GltfPlacement& placement : nodes)
        if (!shared(placement))
            builder.addMesh(static_cast<int>(meshOf(placement)), 0, placement.toWorld);
    builder.startGroups();
    int groups = 0;
    for (const GltfPlacement& placement : nodes) {
        if (!shared(placement)) continue;
        int& number = group[meshOf(placement)];
        if (number == 0) {
            number = ++groups;
            builder.addMesh(static_cast<int>(meshOf(placement)), number, {});
        }
        builder.addInstance(number, placement.toWorld);
    }
    return builder.finish();
}

RawMesh readGltf(const std::filesystem::path& path, References references) {
    const GltfDocument document = readGltfDocument(path, references);
    const GltfNodes nodes(document);
    std::vector<GltfPlacement> still;
    std::size_t moving = 0;
    for (int i = 0; i < static_cast<int>(document.nodes.size()); ++i) {
        const GltfNode& node = document.nodes[static_cast<std::size_t>(i)];
        if (!node.inScene || node.mesh < 0) continue;
        if (nodes.moves(i))
            ++moving;
        else
            still.push_back({i, nodes.at(i, 0)});
    }
    RawMesh mesh = gltfMesh(document, still, false);
    mesh.moving = moving;
    return mesh;
}

}  // namespace shadowcache
