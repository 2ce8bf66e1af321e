// Integers of glTF may be written 1.0 or 1e0 [glTF 2.0, Sec. 2.7]: each of them, in the core and in
// the extensions that are read.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <optional>
#include <set>

#include "common/import/load_mesh.h"
#include "common/mesh/mesh_fingerprint.h"
#include "common/shot/moving_set.h"
#include "tests/support/compressed_gltf.h"
#include "tests/support/gltf_posed.h"
#include "tests/support/loaded_mesh.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

using Json = nlohmann::json;

/// Texture coordinates in the second set; a picture that is clamped, and one in WebP that the
/// extension names.
int addMaterial(GltfBuilder& file) {
    const int red = file.append("images", {{"bufferView", file.view(webpPicture())}});
    file.append("images", {{"bufferView", file.view("no picture")}});
    file.append("samplers", Json::object());
    file.append("samplers",
                {{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}, {"minFilter", 9728}});
    file.append("textures", {{"source", 1}});
    const int texture = file.append(
        "textures",
        {{"sampler", 1}, {"source", 1}, {"extensions", {{"EXT_texture_webp", {{"source", red}}}}}});
    const Json transform{{"texCoord", 1}, {"offset", {0.25, 0.125}}};
    file.append("materials", Json::object());
    return file.append(
        "materials",
        {{"pbrMetallicRoughness",
          {{"baseColorTexture", {{"index", texture}, {"texCoord", 1}}},
           {"metallicRoughnessTexture",
            {{"index", texture}, {"extensions", {{"KHR_texture_transform", transform}}}}}}},
         {"normalTexture", {{"index", texture}, {"texCoord", 1}}},
         {"extensions",
          {{"KHR_materials_specular", {{"specularTexture", {{"index", texture}}}}}}}});
}

/// A mesh in meshopt's compression, with a morph target that is sparse.
int addMorphed(GltfBuilder& file, int material) {
    const int plain = file.view(meshoptPositions());
    Json& view = file.json["bufferViews"][static_cast<std::size_t>(plain)];
    Json compressed = view;
    compressed.update({{"byteStride", 12}, {"count", 4}, {"mode", "ATTRIBUTES"}});
    view["extensions"]["EXT_meshopt_compression"] = compressed;
    const int positions = file.append(
        "accessors",
        {{"bufferView", plain}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}});
    const std::vector<float> uv{0, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0};
    std::string bytes;
    for (const float x : uv) bytes += bytesOf(x);
    const int pairs = file.append("accessors", {{"bufferView", file.view(bytes, 16)},
                                                {"byteOffset", 0},
                                                {"componentType", 5126},
                                                {"count", 4},
                                                {"type", "VEC2"}});
    const int zeros = file.accessor(std::vector<float>{0, 0, 0, 0, 0, 0, 0, 0}, "VEC2", 2);
    const Json sparse{{"count", 1},
                      {"indices",
                       {{"bufferView", file.view(std::string("..\2", 3))},
                        {"byteOffset", 2},
                        {"componentType", 5121}}},
                      {"values",
                       {{"bufferView", file.view(bytesOf(std::array<float, 4>{9, 2, 0, 0}))},
                        {"byteOffset", 4}}}};
    const int target = file.append(
        "accessors", {{"componentType", 5126}, {"count", 4}, {"type", "VEC3"}, {"sparse", sparse}});
    const int mesh = file.mesh(
        {{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", zeros}, {"TEXCOORD_1", pairs}}},
         {"indices", file.accessor(std::vector<std::uint8_t>{0, 1, 3, 2}, "SCALAR", 1)},
         {"mode", 5},
         {"material", material},
         {"targets", {{{"POSITION", target}}}}});
    file.json["meshes"][static_cast<std::size_t>(mesh)]["weights"] = {0.5};
    return mesh;
}

int addDraco(GltfBuilder& file) {
    const int view = file.view(dracoSquare(draco::MESH_SEQUENTIAL_ENCODING));
    const int positions =
        file.append("accessors", {{"componentType", 5126}, {"count", 4}, {"type", "VEC3"}});
    const int indices =
        file.append("accessors", {{"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}});
    const Json draco{{"bufferView", view}, {"attributes", {{"POSITION", 0}}}};
    return file.mesh({{"attributes", {{"POSITION", positions}}},
                      {"indices", indices},
                      {"extensions", {{"KHR_draco_mesh_compression", draco}}}});
}

/// All that has integers. Every other number is written with a fraction.
GltfBuilder everything() {
    GltfBuilder file = skinnedBar().file;  // whose numbers are whole
    for (Json& node : file.json["nodes"]) node.erase("translation");
    const int morphed = addMorphed(file, addMaterial(file));
    const int cameraNumber = file.append(
        "cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.75}, {"znear", 0.1}}}});
    file.append("cameras", {{"type", "orthographic"}, {"orthographic", {{"ymag", 0.0}}}});
    const int below = file.append("nodes", {{"mesh", morphed}, {"translation", {3.5, 0.0, 0.0}}});
    const int moved =
        file.root({{"name", "moved"}, {"mesh", addDraco(file)}, {"children", {below}}});
    file.root({{"name", "eye"}, {"camera", cameraNumber}, {"translation", {0.0, 0.0, 9.5}}});
    Json many = instancesAt(file, {0, 5, 0, 1, 5, 0, 2, 5, 0});
    many["mesh"] = morphed;
    file.root(many);
    file.animate(moved, "translation", "LINEAR", {0, 1}, {0, 0, 0, 0, 0, 4});
    // The scene that is not the first.
    file.json["scenes"].insert(file.json["scenes"].begin(), Json{{"nodes", {below}}});
    file.json["scene"] = 1;
    file.json["asset"]["extras"] = "numbers";
    return file;
}

/// A file's JSON, and what it names.
struct Written {
    Json json;
    std::string data;
};

Written written(const GltfBuilder& file) {
    return {Json::parse(file.gltf("a.bin")), file.data()};
}

/// All that the renderer gets.
std::string loaded(const std::string& json, const std::string& data) {
    const TemporaryFolder folder;
    folder.write("a.bin", data);
    const auto path = folder.write("a.gltf", json);
    std::string text;
    const auto add = [&](const auto&... numbers) { ((text += fmt::format("{} ", numbers)), ...); };
    for (const std::optional<double>& still : {std::optional<double>(), std::optional(0.25)}) {
        const TriangleMesh mesh =
            loadMesh({&path, 1}, {.shadingNormals = true, .gloss = true, .stillAt = still});
        add(describe(mesh.report), fingerprint(mesh));
        for (const Vec3f& at : mesh.texcoords) add(at.x, at.y, at.z);
        for (const auto& layer : mesh.moreTexcoords)
            for (const Vec2f& at : layer) add(at.x, at.y);
        for (const Texture& t : mesh.textures)
            add(t.width, t.height, t.rgba.size(), int(t.wrapS), int(t.wrapT), t.smooth);
        for (const MeshPart& part : mesh.parts) add(part.triangleCount, part.material);
        for (const Material& m : mesh.materials)
            add(m.texture, m.normal.texture, m.normal.layer, m.finish.metallicRoughness.layer,
                m.finish.specular.texture, m.finish.specular.layer);
    }
    const GltfShot shot(path, {}, 24);
    text += describe(shot).substr(path.string().size());
    MovingSet moving({&shot, 1}, {}, {}, Vec3d(0.0));
    const Scene* scene = moving.pose(7);
    if (scene) add(fingerprint(scene->mesh()));
    return text;
}

/// Calls `visit` for each whole number below a value, with the last name on the way to it.
void eachInteger(Json& value, const std::string& key,
                 const std::function<void(Json&, const std::string&)>& visit) {
    if (value.is_number_integer()) return visit(value, key);
    if (!value.is_structured()) return;
    for (auto& item : value.items())
        eachInteger(item.value(), value.is_object() ? item.key() : key, visit);
}

/// JSON in which texts "@1.0@" become numbers as they stand.
std::string withNumbers(const Json& json) {
    std::string text = json.dump();
    for (const char* mark : {"\"@", "@\""})
        for (std::size_t at = text.find(mark); at != text.npos; at = text.find(mark, at))
            text.erase(at, 2);
    return text;
}

TEST(GltfIntegers, MayBeWrittenAsOtherNumbers) {
    const Written plain = written(everything());
    const std::string wanted = loaded(plain.json.dump(), plain.data);
    EXPECT_NE(wanted.find("perspective"), std::string::npos) << wanted;
    EXPECT_NE(wanted.find("moves: moved"), std::string::npos) << wanted;
    for (const char* form : {"@{}.0@", "@{}e0@", "@{}.000E+00@"}) {
        Json json = plain.json;
        std::size_t count = 0;
        eachInteger(json, "", [&](Json& value, const std::string&) {
            value = fmt::format(fmt::runtime(form), value.get<int>());
            ++count;
        });
        EXPECT_GT(count, 150u);
        EXPECT_EQ(loaded(withNumbers(json), plain.data), wanted) << form;
    }
}

/// Control: other numbers are refused by their names. Those of what no node leads to are not read.
// Of floats `normalized` is an error of the file: it stands for nothing.
TEST(GltfIntegers, AloneAreNormalized) {
    GltfBuilder file;
    const int positions = file.vectors({-3, 0, 0, 3, 0, 0, 3, 0, 3});
    file.mesh({{"attributes", {{"POSITION", positions}}}});
    file.root({{"mesh", 0}});
    const TriangleMesh plain = loadGlb(file);
    file.json["accessors"][static_cast<std::size_t>(positions)]["normalized"] = true;
    EXPECT_EQ(loadGlb(file).positions, plain.positions);
}

TEST(GltfIntegers, ThatAreNoneAreRefusedByName) {
    Written file = written(everything());
    std::set<std::string> unread, refused;
    eachInteger(file.json, "", [&](Json& value, const std::string& key) {
        const Json whole = value;
        value = whole.get<int>() + 0.5;
        unread.insert(key);
        try {
            loaded(file.json.dump(), file.data);
        } catch (const Error& e) {
            refused.insert(key);
            const std::string text = e.what();
            EXPECT_NE(text.find(key + " "), std::string::npos) << key << ": " << text;
            EXPECT_NE(text.find(", expected a whole number"), std::string::npos) << text;
        }
        value = whole;
    });
    for (const std::string& key : refused) unread.erase(key);
    EXPECT_EQ(unread, std::set<std::string>{"minFilter"});
    EXPECT_GT(refused.size(), 30u);
}

}  // namespace
}  // namespace shadowcache::test
