#include "common/import/gltf_document.h"

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <fmt/core.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.h"
#include "common/import/gltf_extensions.h"
#include "common/import/gltf_file.h"
#include "common/import/gltf_uris.h"

namespace shadowcache {

namespace {

/// Accessors of nothing but zeros could claim any size; those of real files are small.
constexpr std::size_t kMaxZeros = std::size_t{1} << 20;

/// Turns tinygltf's model, which checks little, into a document.
class Converter {
public:
    Converter(const std::filesystem::path& path, tinygltf::Model model)
        : path_(path), model_(std::move(model)) {}

    GltfDocument run() {
        out_.path = path_;
        for (auto& buffer : model_.buffers) out_.storage.push_back(std::move(buffer.data));
        for (std::size_t i = 0; i < model_.accessors.size(); ++i) addAccessor(i);
        for (const auto& texture : model_.textures) addTexture(texture);
        for (const auto& material : model_.materials) addMaterial(material);
        for (const auto& mesh : model_.meshes) addMesh(mesh);
        for (const auto& camera : model_.cameras) addCamera(camera);
        for (const auto& node : model_.nodes) addNode(node);
        for (const auto& skin : model_.skins) addSkin(skin);
        linkNodes();
        countLeftOut();
        for (const auto& animation : model_.animations) addAnimation(animation);
        return std::move(out_);
    }

private:
    [[noreturn]] void fail(const std::string& cause) const { throwFileError(path_, cause); }

    template <class T>
    void requireIndex(const std::string& what, int index, const std::vector<T>& list) const {
        if (index < 0 || static_cast<std::size_t>(index) >= list.size())
            fail(fmt::format("{} {}{}", what, index,
                             list.empty() ? ", but the file has none"
                                          : fmt::format(", expected 0 to {}", list.size() - 1)));
    }

    void requireFinite(const std::string& what, const std::vector<double>& values) const {
        for (const double v : values)
            if (!std::isfinite(v)) fail(what + " is not finite");
    }

    std::string_view viewBytes(const std::string& owner, int index) const {
        requireIndex(owner + ": buffer view", index, model_.bufferViews);
        const auto& view = model_.bufferViews[static_cast<std::size_t>(index)];
        requireIndex(owner + ": buffer", view.buffer, out_.storage);
        const auto& data = out_.storage[static_cast<std::size_t>(view.buffer)];
        if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
            fail(fmt::format("{}: {} bytes at {} of a buffer of {}, expected them within it", owner,
                             view.byteLength, view.byteOffset, data.size()));
        return {reinterpret_cast<const char*>(data.data()) + view.byteOffset, view.byteLength};
    }

    /// `count` elements of a buffer view.
    GltfArray array(const std::string& owner, int view, std::size_t offset, int type,
                    std::size_t components, std::size_t count) const {
        const std::size_t element = gltfTypeSize(type) * components;
        if (element == 0)
            fail(fmt::format("{}: component type {}, expected 5120 to 5123, 5125 or 5126", owner,
                             type));
        GltfArray result{{}, static_cast<GltfType>(type), components, element};
        if (view < 0) return result;
        const std::string_view bytes = viewBytes(owner, view);
        const std::size_t stride = model_.bufferViews[static_cast<std::size_t>(view)].byteStride;
        if (stride != 0) result.stride = stride;
        const std::size_t room = bytes.size() < offset ? 0 : bytes.size() - offset;
        if (result.stride < element || room < element ||
            (room - element) / result.stride < count - 1)
            fail(
                fmt::format("{}: {} elements of {} bytes do not fit into the {} of its buffer view",
                            owner, count, element, room));
        result.bytes = bytes.substr(offset);
        return result;
    }

    void addAccessor(std::size_t i) {
        const tinygltf::Accessor& from = model_.accessors[i];
        const std::string owner = fmt::format("accessor {}", i);
        if (from.count == 0) fail(owner + ": no elements, expected at least one");
        const int components =
            tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(from.type));
        GltfAccessor to{from.count, from.normalized, {}, {}};
        to.array = array(owner, from.bufferView, from.byteOffset, from.componentType,
                         static_cast<std::size_t>(std::max(0, components)), from.count);
        if (to.array.bytes.empty() && from.count > kMaxZeros)
            fail(fmt::format("{}: {} zeros, expected at most {}", owner, from.count, kMaxZeros));
        if (from.sparse.isSparse) addSparse(owner, from, to);
        out_.accessors.push_back(to);
    }

    void addSparse(const std::string& owner, const tinygltf::Accessor& from, GltfAccessor& to) {
        const auto& sparse = from.sparse;
        if (sparse.count < 1 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
            fail(owner + ": sparse count or offset out of range");
        if (sparse.indices.bufferView < 0 || sparse.values.bufferView < 0)
            fail(owner + ": sparse accessor without a buffer view");
        const auto count = static_cast<std::size_t>(sparse.count);
        const int type = sparse.indices.componentType;
        const std::string bad = badIndexType(type);
        if (!bad.empty()) fail(owner + ": sparse indices of " + bad);
        to.sparse =
            GltfSparse{count,
                       array(owner, sparse.indices.bufferView,
                             static_cast<std::size_t>(sparse.indices.byteOffset), type, 1, count),
                       array(owner, sparse.values.bufferView,
                             static_cast<std::size_t>(sparse.values.byteOffset), from.componentType,
                             to.array.components, count)};
    }

    static Texture::Wrap wrapOf(int code) {
        if (code == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Texture::Wrap::clamp;
        if (code == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return Texture::Wrap::mirror;
        return Texture::Wrap::repeat;
    }

    /// The picture of EXT_texture_webp, which core glTF's only stands in for.
    static int sourceOf(const tinygltf::Texture& from) {
        const auto webp = from.extensions.find("EXT_texture_webp");
        if (webp == from.extensions.end() || !webp->second.Get("source").IsNumber())
            return from.source;
        return webp->second.Get("source").GetNumberAsInt();
    }

    void addTexture(const tinygltf::Texture& from) {
        GltfTexture to;
        if (from.sampler >= 0) {
            requireIndex("sampler", from.sampler, model_.samplers);
            const auto& sampler = model_.samplers[static_cast<std::size_t>(from.sampler)];
            to.sampler.wrapS = wrapOf(sampler.wrapS);
            to.sampler.wrapT = wrapOf(sampler.wrapT);
            to.sampler.smooth = sampler.magFilter != TINYGLTF_TEXTURE_FILTER_NEAREST;
        }
        // A texture without a picture here has one in another extension.
        if (const int source = sourceOf(from); source >= 0) {
            requireIndex("image", source, model_.images);
            auto& image = model_.images[static_cast<std::size_t>(source)];
            to.name = fmt::format(
                "image {}{}", source,
                image.uri.empty() || isDataUri(image.uri) ? "" : fmt::format(" ({})", image.uri));
            if (image.bufferView >= 0) {
                to.encoded = viewBytes(to.name, image.bufferView);
            } else if (!image.image.empty()) {
                out_.storage.push_back(image.image);
                const auto& bytes = out_.storage.back();
                to.encoded = {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
            }
        }
        out_.textures.push_back(to);
    }

    void addMaterial(const tinygltf::Material& from) {
        out_.materials.push_back(gltfMaterial(path_, from, model_.textures.size()));
        GltfMaterial& material = out_.materials.back();
        int& picture = material.material.finish.metallicRoughness.texture;
        if (!material.glossiness || picture < 0) return;
        GltfTexture roughness = out_.textures[static_cast<std::size_t>(picture)];
        roughness.glossiness = material.glossiness;
        picture = static_cast<int>(out_.textures.size());
        out_.textures.push_back(roughness);
    }

    void addMesh(const tinygltf::Mesh& from) {
        GltfMesh to{from.name, {}, from.weights};
        requireFinite("mesh " + from.name + ": a weight", from.weights);
        for (const auto& primitive : from.primitives) {
            GltfPrimitive p{primitive.mode < 0 ? 4 : primitive.mode, primitive.indices,
                            primitive.material, primitive.attributes, primitive.targets};
            if (p.mode > 6)
                fail(fmt::format("mesh {}: mode {}, expected 0 to 6", from.name, p.mode));
            if (p.indices >= 0) requireIndex("index accessor", p.indices, out_.accessors);
            if (p.material >= 0) requireIndex("material", p.material, out_.materials);
            for (const auto& [name, accessor] : p.attributes)
                requireIndex(name + " accessor", accessor, out_.accessors);
            for (const auto& target : p.targets)
                for (const auto& [name, accessor] : target)
                    requireIndex("morph target's " + name + " accessor", accessor, out_.accessors);
            to.primitives.push_back(std::move(p));
        }
        out_.meshes.push_back(std::move(to));
    }

    void addCamera(const tinygltf::Camera& from) {
        GltfCamera to;
        to.name = from.name;
        to.orthographic = from.type == "orthographic";
        to.fovY = from.perspective.yfov;
        to.height = 2 * from.orthographic.ymag;
        if (!to.orthographic && !(to.fovY > 0 && to.fovY < 3.14159))
            fail(fmt::format("camera {}: yfov {:f}, expected radians in (0, pi)", from.name,
                             to.fovY));
        if (to.orthographic && !(to.height > 0 && std::isfinite(to.height)))
            fail(fmt::format("camera {}: ymag {:f}, expected a number above 0", from.name,
                             to.height / 2));
        out_.cameras.push_back(to);
    }

    void addNode(const tinygltf::Node& from) {
        GltfNode to;
        to.name = from.name;
        to.mesh = from.mesh;
        to.camera = from.camera;
        to.skin = from.skin;
        to.weights = from.weights;
        requireFinite("node " + from.name + ": a weight", from.weights);
        if (to.mesh >= 0) requireIndex("mesh", to.mesh, out_.meshes);
        if (to.camera >= 0) requireIndex("camera", to.camera, out_.cameras);
        if (to.skin >= 0) requireIndex("skin", to.skin, model_.skins);
        addInstancing(from, to);
        if (const auto& m = from.matrix; m.size() == 16)
            to.matrix =
                Affine{{Vec3d(m[0], m[1], m[2]), Vec3d(m[4], m[5], m[6]), Vec3d(m[8], m[9], m[10])},
                       Vec3d(m[12], m[13], m[14])};
        if (const auto& t = from.translation; t.size() == 3) to.translation = {t[0], t[1], t[2]};
        if (const auto& s = from.scale; s.size() == 3) to.scale = {s[0], s[1], s[2]};
        if (const auto& q = from.rotation; q.size() == 4) to.rotation = {q[0], q[1], q[2], q[3]};
        requireFinite("node " + from.name,
                      {to.translation.x, to.translation.y, to.translation.z, to.scale.x, to.scale.y,
                       to.scale.z, to.rotation[0], to.rotation[1], to.rotation[2], to.rotation[3]});
        if (to.matrix && !to.matrix->isFinite()) fail("node " + from.name + " is not finite");
        out_.nodes.push_back(std::move(to));
    }

    void addInstancing(const tinygltf::Node& from, GltfNode& to) const {
        const auto found = from.extensions.find("EXT_mesh_gpu_instancing");
        if (found == from.extensions.end()) return;
        const std::string owner = "node " + from.name + ": EXT_mesh_gpu_instancing";
        const tinygltf::Value& attributes = found->second.Get("attributes");
        for (const std::string& name : attributes.Keys()) {
            const tinygltf::Value& accessor = attributes.Get(name);
            if (!accessor.IsInt()) fail(owner + " " + name + ": expected an accessor");
            requireIndex(owner + " " + name, accessor.GetNumberAsInt(), out_.accessors);
            to.instancing[name] = accessor.GetNumberAsInt();
        }
        if (to.instancing.empty()) fail(owner + ": no attributes, expected at least one");
    }

    void addSkin(const tinygltf::Skin& from) {
        const GltfSkin to{from.joints, from.inverseBindMatrices};
        const std::string owner = "skin " + from.name;
        if (to.joints.empty()) fail(owner + ": no joints, expected at least one");
        for (const int joint : to.joints) requireIndex(owner + ": joint", joint, out_.nodes);
        if (to.inverseBind >= 0)
            requireIndex(owner + ": inverse bind matrices", to.inverseBind, out_.accessors);
        out_.skins.push_back(to);
    }

    void linkNodes() {
        for (std::size_t i = 0; i < model_.nodes.size(); ++i)
            for (const int child : model_.nodes[i].children) {
                requireIndex("child node", child, out_.nodes);
                int& parent = out_.nodes[static_cast<std::size_t>(child)].parent;
                if (parent >= 0) fail(fmt::format("node {} has two parents, expected one", child));
                parent = static_cast<int>(i);
            }
        for (const int root : sceneRoots()) enterScene(root);
        requireTree();
    }

    /// Each node has one parent at most, so that a node that no root leads to is in a ring.
    void requireTree() const {
        std::vector<int> open;
        std::size_t reached = 0;
        for (std::size_t i = 0; i < out_.nodes.size(); ++i)
            if (out_.nodes[i].parent < 0) open.push_back(static_cast<int>(i));
        while (!open.empty()) {
            const auto i = static_cast<std::size_t>(open.back());
            open.pop_back();
            ++reached;
            open.insert(open.end(), model_.nodes[i].children.begin(),
                        model_.nodes[i].children.end());
        }
        if (reached < out_.nodes.size())
            fail(fmt::format("{} nodes are below themselves, expected a tree",
                             out_.nodes.size() - reached));
    }

    /// Of the default scene, or the first; all of a file without scenes.
    std::vector<int> sceneRoots() const {
        std::vector<int> roots;
        if (model_.scenes.empty()) {
            for (std::size_t i = 0; i < out_.nodes.size(); ++i)
                if (out_.nodes[i].parent < 0) roots.push_back(static_cast<int>(i));
            return roots;
        }
        const int scene = std::max(0, model_.defaultScene);
        requireIndex("scene", scene, model_.scenes);
        roots = model_.scenes[static_cast<std::size_t>(scene)].nodes;
        for (const int root : roots) {
            requireIndex("scene's node", root, out_.nodes);
            if (out_.nodes[static_cast<std::size_t>(root)].parent >= 0)
                fail(fmt::format("node {} of the scene has a parent, expected none", root));
        }
        return roots;
    }

    bool isHidden(std::size_t node) const {
        const auto& extensions = model_.nodes[node].extensions;
        const auto found = extensions.find("KHR_node_visibility");
        if (found == extensions.end()) return false;
        const tinygltf::Value& visible = found->second.Get("visible");
        return visible.IsBool() && !visible.Get<bool>();
    }

    /// A node and those below it; a hidden one hides their meshes.
    void enterScene(int root) {
        std::vector<std::pair<int, bool>> open{{root, false}};
        while (!open.empty()) {
            const auto i = static_cast<std::size_t>(open.back().first);
            const bool hidden = open.back().second || isHidden(i);
            open.pop_back();
            GltfNode& node = out_.nodes[i];
            if (node.inScene) fail(fmt::format("node {} is in the scene twice, expected once", i));
            node.inScene = true;
            if (hidden) node.mesh = -1;
            for (const int child : model_.nodes[i].children) open.emplace_back(child, hidden);
        }
    }

    void countLeftOut() {
        std::vector<bool> inScene;
        inScene.reserve(out_.nodes.size());
        for (const GltfNode& node : out_.nodes) inScene.push_back(node.inScene);
        shadowcache::countLeftOut(model_, inScene, out_.leftOutOf);
    }

    void addAnimation(const tinygltf::Animation& from) {
        GltfAnimation to{from.name, {}};
        for (const auto& channel : from.channels) {
            // A channel without node belongs to an extension.
            if (channel.target_node < 0) continue;
            requireIndex("animated node", channel.target_node, out_.nodes);
            requireIndex("animation sampler", channel.sampler, from.samplers);
            const auto& sampler = from.samplers[static_cast<std::size_t>(channel.sampler)];
            requireIndex("animation input", sampler.input, out_.accessors);
            requireIndex("animation output", sampler.output, out_.accessors);
            GltfChannel c;
            c.node = channel.target_node;
            c.times = sampler.input;
            c.values = sampler.output;
            using Interpolation = GltfChannel::Interpolation;
            c.interpolation = sampler.interpolation == "STEP"          ? Interpolation::step
                              : sampler.interpolation == "CUBICSPLINE" ? Interpolation::cubicSpline
                                                                       : Interpolation::linear;
            using Path = GltfChannel::Path;
            if (channel.target_path == "translation")
                c.path = Path::translation;
            else if (channel.target_path == "rotation")
                c.path = Path::rotation;
            else if (channel.target_path == "scale")
                c.path = Path::scale;
            else if (channel.target_path == "weights")
                c.path = Path::weights;
            else
                continue;
            to.channels.push_back(c);
        }
        out_.animations.push_back(std::move(to));
    }

    const std::filesystem::path& path_;
    tinygltf::Model model_;
    GltfDocument out_;
};

}  // namespace

std::size_t GltfMesh::targetCount() const {
    std::size_t most = 0;
    for (const GltfPrimitive& p : primitives) most = std::max(most, p.targets.size());
    return most;
}

GltfDocument readGltfDocument(const std::filesystem::path& path, References references) {
    return Converter(path, readGltfFile(path, references)).run();
}

}  // namespace shadowcache
