#include "common/import/gltf_document.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "common/base/error.h"
#include "common/import/gltf_draco.h"
#include "common/import/gltf_extensions.h"
#include "common/import/gltf_file.h"
#include "common/import/gltf_lamp.h"

namespace shadowcache {

namespace {

constexpr const char* kDraco = "KHR_draco_mesh_compression";

/// Accessors of nothing but zeros could claim any size: those of a file of any size may have so
/// many elements, and one more for each of its bytes.
constexpr std::size_t kMostZeros = std::size_t{1} << 20;

constexpr int kMostMode = 6, kDefaultMode = 4;

constexpr Named<std::size_t> kComponents[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                                              {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};

/// How far from 0, 0, 0, 1 the last row of a matrix may be: programs that multiply in float write
/// such noise.
constexpr double kMatrixNoise = 1e-5;

/// What KHR_animation_pointer points to is no node's.
using Path = GltfChannel::Path;
constexpr Named<std::optional<Path>> kPaths[] = {{"translation", Path::translation},
                                                 {"rotation", Path::rotation},
                                                 {"scale", Path::scale},
                                                 {"weights", Path::weights},
                                                 {"pointer", std::nullopt}};

using Interpolation = GltfChannel::Interpolation;
constexpr Named<Interpolation> kInterpolations[] = {{"LINEAR", Interpolation::linear},
                                                    {"STEP", Interpolation::step},
                                                    {"CUBICSPLINE", Interpolation::cubicSpline}};

Vec3d vectorOr(const std::vector<double>& found, const Vec3d& fallback) {
    return found.empty() ? fallback : Vec3d(found[0], found[1], found[2]);
}

std::optional<Affine> matrixOf(const GltfObject& node) {
    const std::vector<double> m = node.numbers("matrix", 16);
    if (m.empty()) return {};
    for (std::size_t k = 0; k < 4; ++k)
        if (!(std::abs(m[4 * k + 3] - (k == 3 ? 1 : 0)) <= kMatrixNoise))
            node.refuse("matrix", "0, 0, 0, 1 in the last row");
    return Affine{{Vec3d(m[0], m[1], m[2]), Vec3d(m[4], m[5], m[6]), Vec3d(m[8], m[9], m[10])},
                  Vec3d(m[12], m[13], m[14])};
}

Texture::Wrap wrapOf(const GltfObject& sampler, const char* key) {
    switch (sampler.count(key, 10497)) {
        case 33071:
            return Texture::Wrap::clamp;
        case 33648:
            return Texture::Wrap::mirror;
        case 10497:
            return Texture::Wrap::repeat;
    }
    sampler.refuse(key, "33071, 33648 or 10497");
}

/// Vertex attributes of a program's own are not read.
bool isOwn(const std::string& attribute) {
    return attribute.starts_with('_');
}

/// Whether what a vertex attribute says is read, of whatever a file uses it for.
bool isReadOfVertices(const std::string& attribute) {
    for (const char* numbered : {"TEXCOORD_", "JOINTS_", "WEIGHTS_"})
        if (attribute.starts_with(numbered)) return true;
    return attribute == "POSITION" || attribute == "NORMAL" || attribute == "TANGENT" ||
           attribute == "COLOR_0";
}

bool isReadOfInstances(const std::string& attribute) {
    return attribute == "TRANSLATION" || attribute == "ROTATION" || attribute == "SCALE";
}

/// Whether the part at an index has not been asked for before.
bool isNew(std::vector<bool>& known, int index) {
    const auto i = static_cast<std::size_t>(index);
    const bool was = known[i];
    known[i] = true;
    return !was;
}

/// Reads the nodes, and what those of the scene lead to.
class Reader {
public:
    Reader(const std::filesystem::path& path, References references)
        : path_(path), file_(path, references), root_(file_.root()) {
        out_.path = path;
        for (Kind* kind : {&accessors_, &cameras_, &materials_, &meshes_, &nodes_, &skins_,
                           &textures_, &samplers_, &scenes_})
            kind->take(root_);
        lights_.take(root_.extension(kGltfLights));
        out_.lights.resize(lights_.size());
        out_.accessors.resize(accessors_.size());
        out_.cameras.resize(cameras_.size());
        out_.materials.resize(materials_.size());
        out_.meshes.resize(meshes_.size());
        out_.skins.resize(skins_.size());
        out_.textures.resize(textures_.size());
    }

    GltfDocument run() {
        for (const GltfObject& node : nodes_.objects) addNode(node);
        linkNodes();
        for (std::size_t i = 0; i < out_.nodes.size(); ++i)
            if (out_.nodes[i].inScene) readNode(nodes_.objects[i], out_.nodes[i]);
        extensions_.addOthers(root_);
        if (file_.isMended())
            ++out_.leftOutOf[{"file", "texts are not UTF-8 (such bytes are replaced)"}];
        for (const GltfObject& animation : root_.objects("animations", "animation"))
            addAnimation(animation);
        nameReplaced();
        out_.storage = file_.takeStorage();
        return std::move(out_);
    }

private:
    /// One of the file's lists.
    struct Kind {
        const char *list, *name;
        std::vector<GltfObject> objects{};
        std::vector<bool> known{};  ///< by object: whether it has been read
        void take(const GltfObject& from) {
            objects = from.objects(list, name);
            known.resize(objects.size());
        }
        std::size_t size() const { return objects.size(); }
        const GltfObject& at(int index) const { return objects[static_cast<std::size_t>(index)]; }
    };

    [[noreturn]] void fail(const std::string& cause) const { throwFileError(path_, cause); }

    // Data.

    /// `count` elements of a buffer view.
    GltfArray array(const GltfObject& from, GltfType type, std::size_t components,
                    std::size_t count) {
        const std::size_t element = gltfTypeSize(static_cast<int>(type)) * components;
        GltfArray result{{}, type, components, element};
        const int view = from.index("bufferView", file_.viewCount(), "buffer view");
        if (view < 0 || count == 0) return result;
        const std::string_view bytes = file_.view(from, view);
        const std::size_t offset = from.count("byteOffset", 0);
        if (const std::size_t stride = file_.stride(view); stride != 0) result.stride = stride;
        const std::size_t room = bytes.size() < offset ? 0 : bytes.size() - offset;
        if (result.stride < element || room < element ||
            (room - element) / result.stride < count - 1)
            from.fail(
                fmt::format("{} elements of {} bytes do not fit into the {} of its buffer "
                            "view",
                            count, element, room));
        result.bytes = bytes.substr(offset);
        return result;
    }

    GltfType typeOf(const GltfObject& from) const {
        const std::size_t type = from.count("componentType", 0);
        if (type > 9999 || gltfTypeSize(static_cast<int>(type)) == 0)
            from.fail(fmt::format("component type {}, expected 5120 to 5123, 5125 or 5126", type));
        return static_cast<GltfType>(type);
    }

    /// What an accessor says of itself.
    GltfAccessor accessorHead(const GltfObject& from) const {
        GltfAccessor to{from.count("count", 0), from.flag("normalized", false), {}, {}};
        for (const char* key : {"count", "type"})
            if (!from.has(key)) from.fail(std::string("no ") + key);
        to.array.type = typeOf(from);
        to.array.components = from.choice("type", kComponents, std::size_t{1});
        to.array.stride = gltfTypeSize(static_cast<int>(to.array.type)) * to.array.components;
        return to;
    }

    GltfAccessor readAccessor(const GltfObject& from) {
        GltfAccessor to = accessorHead(from);
        to.array = array(from, to.array.type, to.array.components, to.count);
        const std::size_t mostZeros = kMostZeros + file_.size();
        if (to.array.bytes.empty() && to.count > mostZeros)
            from.fail(fmt::format("{} zeros, expected at most {}", to.count, mostZeros));
        if (!from.has("sparse")) return to;
        const GltfObject sparse = from.object("sparse"), indices = sparse.object("indices"),
                         values = sparse.object("values");
        GltfSparse& differs = to.sparse.emplace();
        differs.count = sparse.count("count", 0);
        if (differs.count == 0) sparse.fail("no elements, expected at least one");
        for (const GltfObject& part : {indices, values})
            if (!part.has("bufferView")) part.fail("no buffer view");
        const GltfType type = typeOf(indices);
        const std::string bad = badIndexType(static_cast<int>(type));
        if (!bad.empty()) indices.fail(bad);
        differs.indices = array(indices, type, 1, differs.count);
        differs.values = array(values, to.array.type, to.array.components, differs.count);
        return to;
    }

    /// The accessor that a member names; -1: none.
    int accessor(const GltfObject& user, const char* key) {
        const int index = user.index(key, accessors_.size(), std::string(key) + " accessor");
        if (index >= 0 && isNew(accessors_.known, index))
            out_.accessors[static_cast<std::size_t>(index)] = readAccessor(accessors_.at(index));
        return index;
    }

    /// An accessor of decoded bytes.
    int addAccessor(const GltfObject& user, GltfAccessor accessor, std::string bytes) {
        accessor.array.bytes = file_.keep(user, std::move(bytes));
        out_.accessors.push_back(accessor);
        return static_cast<int>(out_.accessors.size()) - 1;
    }

    // Looks.

    void readTexture(int index) {
        if (!isNew(textures_.known, index)) return;
        const GltfObject& from = textures_.at(index);
        GltfTexture& to = out_.textures[static_cast<std::size_t>(index)];
        if (const int number = from.index("sampler", samplers_.size()); number >= 0) {
            const GltfObject& sampler = samplers_.at(number);
            to.sampler.wrapS = wrapOf(sampler, "wrapS");
            to.sampler.wrapT = wrapOf(sampler, "wrapT");
            to.sampler.smooth = sampler.count("magFilter", 0) != 9728;
        }
        // The picture of EXT_texture_webp, which core glTF's only stands in for. A texture without
        // a picture here has one in another extension.
        const GltfObject webp = from.extension("EXT_texture_webp");
        const int picture =
            (webp.has("source") ? webp : from).index("source", file_.pictureCount(), "image");
        if (picture >= 0) to.encoded = file_.picture(picture, to.name);
    }

    int material(const GltfObject& primitive) {
        const int index = primitive.index("material", materials_.size());
        if (index < 0 || !isNew(materials_.known, index)) return index;
        GltfMaterial& to = out_.materials[static_cast<std::size_t>(index)];
        to = gltfMaterial(materials_.at(index), textures_.size());
        for (const int* texture : texturesOf(to.material))
            if (*texture >= 0) readTexture(*texture);
        int& picture = to.material.finish.metallicRoughness.texture;
        if (!to.glossiness || picture < 0) return index;
        GltfTexture roughness = out_.textures[static_cast<std::size_t>(picture)];
        roughness.glossiness = to.glossiness;
        picture = static_cast<int>(out_.textures.size());
        out_.textures.push_back(roughness);
        return index;
    }

    // Meshes.

    std::map<std::string, int> attributes(const GltfObject& from) {
        std::map<std::string, int> found;
        for (const std::string& name : from.keys())
            if (!isOwn(name)) found[name] = accessor(from, name.c_str());
        return found;
    }

    void readDraco(const GltfObject& from, GltfPrimitive& to) {
        const GltfObject extension = from.extension(kDraco);
        const DracoPrimitive draco(
            extension,
            file_.view(extension, extension.index("bufferView", file_.viewCount(), "buffer view")));
        if (!from.has("indices")) extension.fail("no indices, expected those of triangles");
        const GltfObject named = from.object("attributes");
        for (const std::string& name : named.keys()) {
            if (isOwn(name)) continue;
            if (!draco.has(name)) {
                to.attributes[name] = accessor(named, name.c_str());
                continue;
            }
            const int index = named.index(name.c_str(), accessors_.size(), name + " accessor");
            const GltfAccessor head = accessorHead(accessors_.at(index));
            to.attributes[name] = addAccessor(extension, head, draco.bytes(name, head));
        }
        // A strip has fewer than the triangles that the stream holds.
        const auto& corners = draco.corners();
        to.indices =
            addAccessor(extension, {corners.size(), false, {{}, GltfType::uint32, 1, 4}, {}},
                        {reinterpret_cast<const char*>(corners.data()), 4 * corners.size()});
        to.mode = kDefaultMode;
    }

    GltfPrimitive primitive(const GltfObject& from) {
        GltfPrimitive to;
        to.mode = from.index("mode", kMostMode + 1);
        if (to.mode < 0) to.mode = kDefaultMode;
        extensions_.add("primitive", from);
        for (const std::string& name : from.object("attributes").keys())
            if (!isReadOfVertices(name)) extensions_.addAttribute("primitive", name);
        if (from.hasExtension(kDraco)) {
            readDraco(from, to);
        } else {
            to.attributes = attributes(from.object("attributes"));
            to.indices = accessor(from, "indices");
        }
        to.material = material(from);
        for (const GltfObject& target : from.objects("targets", "morph target"))
            to.targets.push_back(attributes(target));
        return to;
    }

    void readMesh(int index) {
        if (!isNew(meshes_.known, index)) return;
        const GltfObject& from = meshes_.at(index);
        extensions_.add("mesh", from);
        GltfMesh& to = out_.meshes[static_cast<std::size_t>(index)];
        to.name = from.name();
        to.weights = from.numbers("weights");
        for (const GltfObject& each : from.objects("primitives", "primitive"))
            to.primitives.push_back(primitive(each));
    }

    void readSkin(int index) {
        if (!isNew(skins_.known, index)) return;
        const GltfObject& from = skins_.at(index);
        GltfSkin& to = out_.skins[static_cast<std::size_t>(index)];
        to.joints = from.indices("joints", nodes_.size(), "joint");
        if (to.joints.empty()) from.fail("no joints, expected at least one");
        to.inverseBind = accessor(from, "inverseBindMatrices");
    }

    static void readOrthographic(const GltfObject& view, GltfCamera& to) {
        const double x = view.number("xmag", 0), y = view.number("ymag", 0);
        if (!(y > 0)) view.fail(fmt::format("ymag {:g}, expected a number above 0", y));
        if (x < 0) view.fail(fmt::format("xmag {:g}, expected a number above 0", x));
        to.height = 2 * y;
        to.aspect = x / y;
    }

    static void readPerspective(const GltfObject& view, GltfCamera& to) {
        to.fovY = view.number("yfov", 0);
        if (!(to.fovY > 0 && to.fovY < 3.14159))
            view.fail(fmt::format("yfov {:g}, expected radians in (0, pi)", to.fovY));
        to.aspect = std::max(0.0, view.number("aspectRatio", 0));
    }

    static void readClipPlanes(const GltfObject& view, GltfCamera& to) {
        to.near = view.number("znear", 0);
        to.far = view.number("zfar", to.far);
        if (!(to.near >= 0 && to.near < to.far))
            view.fail(fmt::format("znear {:g} and zfar {:g}, expected 0 <= znear < zfar", to.near,
                                  to.far));
    }

    /// A set without this camera is as good as one with it: what is wrong is told to who wants it.
    void readCamera(int index) {
        if (!isNew(cameras_.known, index)) return;
        const GltfObject& from = cameras_.at(index);
        extensions_.add("camera", from);
        GltfCamera& to = out_.cameras[static_cast<std::size_t>(index)];
        to.name = from.name();
        try {
            to.orthographic = from.text("type") == "orthographic";
            const GltfObject view = from.object(to.orthographic ? "orthographic" : "perspective");
            to.orthographic ? readOrthographic(view, to) : readPerspective(view, to);
            readClipPlanes(view, to);
        } catch (const Error& e) {
            to.fault = e.what();
        }
    }

    void readLight(int index) {
        if (!isNew(lights_.known, index)) return;
        const GltfObject& from = lights_.at(index);
        extensions_.add("light", from);
        out_.lights[static_cast<std::size_t>(index)] = gltfLamp(from, out_.leftOutOf);
    }

    // Nodes.

    void addNode(const GltfObject& from) {
        GltfNode to;
        to.name = from.name();
        to.mesh = from.index("mesh", meshes_.size());
        to.camera = from.index("camera", cameras_.size());
        to.skin = from.index("skin", skins_.size());
        to.light = from.extension(kGltfLights).index("light", lights_.size());
        to.weights = from.numbers("weights");
        to.matrix = matrixOf(from);
        to.translation = vectorOr(from.numbers("translation", 3), to.translation);
        to.scale = vectorOr(from.numbers("scale", 3), to.scale);
        if (const auto q = from.numbers("rotation", 4); !q.empty())
            to.rotation = {q[0], q[1], q[2], q[3]};
        if (std::ranges::all_of(to.rotation, [](double x) { return x == 0; }))
            ++out_.leftOutOf[{"node", "rotation is 0, no quaternion (left out)"}];
        out_.nodes.push_back(std::move(to));
        children_.push_back(from.indices("children", nodes_.size(), "child node"));
    }

    /// What a node of the scene leads to.
    void readNode(const GltfObject& from, GltfNode& to) {
        extensions_.add("node", from);
        if (to.camera >= 0) readCamera(to.camera);
        if (to.light >= 0) readLight(to.light);
        if (to.mesh < 0) return;
        readMesh(to.mesh);
        if (to.skin >= 0) readSkin(to.skin);
        if (!from.hasExtension("EXT_mesh_gpu_instancing")) return;
        const GltfObject instancing = from.extension("EXT_mesh_gpu_instancing");
        const GltfObject named = instancing.object("attributes");
        for (const std::string& name : named.keys()) {
            to.instancing[name] = accessor(named, name.c_str());
            if (!isReadOfInstances(name)) extensions_.addAttribute("instance", name);
        }
        if (to.instancing.empty()) instancing.fail("no attributes, expected at least one");
    }

    void linkNodes() {
        for (std::size_t i = 0; i < children_.size(); ++i)
            for (const int child : children_[i]) {
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
            const std::vector<int>& below = children_[static_cast<std::size_t>(open.back())];
            open.pop_back();
            ++reached;
            open.insert(open.end(), below.begin(), below.end());
        }
        if (reached < out_.nodes.size())
            fail(fmt::format("{} nodes are below themselves, expected a tree",
                             out_.nodes.size() - reached));
    }

    /// Of the default scene, or the first; all of a file without scenes.
    std::vector<int> sceneRoots() {
        std::vector<int> roots;
        if (scenes_.size() == 0) {
            for (std::size_t i = 0; i < out_.nodes.size(); ++i)
                if (out_.nodes[i].parent < 0) roots.push_back(static_cast<int>(i));
            return roots;
        }
        const int scene = std::max(0, root_.index("scene", scenes_.size()));
        extensions_.add("scene", scenes_.at(scene));
        if (scenes_.size() > 1)
            out_.leftOutOf[{"scene", "nodes are left out, as another is the default"}] =
                scenes_.size() - 1;
        roots = scenes_.at(scene).indices("nodes", nodes_.size(), "node");
        for (const int root : roots)
            if (out_.nodes[static_cast<std::size_t>(root)].parent >= 0)
                fail(fmt::format("node {} of the scene has a parent, expected none", root));
        return roots;
    }

    /// A node and those below it; a hidden one hides their meshes and lights.
    void enterScene(int root) {
        std::vector<std::pair<int, bool>> open{{root, false}};
        while (!open.empty()) {
            const auto [number, parentHidden] = open.back();
            open.pop_back();
            const auto i = static_cast<std::size_t>(number);
            const bool hidden =
                parentHidden ||
                !nodes_.at(number).extension("KHR_node_visibility").flag("visible", true);
            GltfNode& node = out_.nodes[i];
            if (node.inScene) fail(fmt::format("node {} is in the scene twice, expected once", i));
            node.inScene = true;
            if (hidden) node.mesh = node.light = -1;
            for (const int child : children_[i]) open.emplace_back(child, hidden);
        }
    }

    // Animations.

    void addAnimation(const GltfObject& from) {
        GltfAnimation to{from.name(), {}};
        const std::vector<GltfObject> samplers = from.objects("samplers", "sampler");
        for (const GltfObject& channel : from.objects("channels", "channel")) {
            const GltfObject target = channel.object("target");
            const auto path = target.choice("path", kPaths, std::optional<Path>());
            const int node = target.index("node", nodes_.size());
            // A channel without node belongs to an extension.
            if (node < 0 || !path) continue;
            const int number = channel.index("sampler", samplers.size());
            if (number < 0) channel.fail("no sampler");
            const GltfObject& sampler = samplers[static_cast<std::size_t>(number)];
            GltfChannel& c = to.channels.emplace_back();
            c.node = node;
            c.path = *path;
            c.interpolation =
                sampler.choice("interpolation", kInterpolations, Interpolation::linear);
            c.times = accessor(sampler, "input");
            c.values = accessor(sampler, "output");
            if (c.times < 0 || c.values < 0) sampler.fail("no input or output");
        }
        out_.animations.push_back(std::move(to));
    }

    /// All animations run together: of those that move a thing, the last counts.
    void nameReplaced() {
        std::map<std::pair<int, Path>, std::size_t> mover;
        std::set<std::size_t> replaced;
        for (std::size_t i = 0; i < out_.animations.size(); ++i)
            for (const GltfChannel& channel : out_.animations[i].channels) {
                const auto [first, isNew] = mover.try_emplace({channel.node, channel.path}, i);
                if (!isNew && first->second != i) replaced.insert(first->second);
                first->second = i;
            }
        for (const std::size_t i : replaced)
            nameOne("animation", "movements give way to those of a later one, where both have some",
                    out_.animations[i].name, out_.leftOutOf);
    }

    const std::filesystem::path& path_;
    GltfFile file_;
    GltfObject root_;
    Kind accessors_{"accessors", "accessor"}, cameras_{"cameras", "camera"},
        materials_{"materials", "material"}, meshes_{"meshes", "mesh"}, nodes_{"nodes", "node"},
        skins_{"skins", "skin"}, textures_{"textures", "texture"}, samplers_{"samplers", "sampler"},
        scenes_{"scenes", "scene"}, lights_{"lights", "light"};
    std::vector<std::vector<int>> children_;  ///< by node
    GltfDocument out_;
    ExtensionCounter extensions_{out_.leftOutOf};
};

}  // namespace

std::size_t GltfMesh::targetCount() const {
    std::size_t most = 0;
    for (const GltfPrimitive& p : primitives) most = std::max(most, p.targets.size());
    return most;
}

GltfDocument readGltfDocument(const std::filesystem::path& path, References references) {
    return Reader(path, references).run();
}

}  // namespace shadowcache
