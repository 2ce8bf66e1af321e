// Extensions of glTF: what is read, left out and named, or refused.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "common/import/load_mesh.h"
#include "common/mesh/placed_mesh.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/loaded_mesh.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

using Json = nlohmann::json;

TEST(GltfExtensions, OfNodesAndMeshesAreNamed) {
    GltfBuilder file = squareScene();
    file.root(
        {{"mesh", 0}, {"translation", {2, 0, 0}}, {"extensions", {{"MSFT_lod", {{"ids", {0}}}}}}});
    file.append("nodes", {{"extensions", {{"MSFT_lod", Json::object()}}}});  // not in the scene
    file.json["meshes"][0]["extensions"] = {{"EXT_some_mesh", Json::object()}};
    file.json["meshes"][0]["primitives"][0]["extensions"] = {
        {"KHR_materials_variants", {{"mappings", Json::array()}}}};
    file.json["scenes"][0]["extensions"] = {{"EXT_lights_image_based", {{"light", 0}}}};
    file.append("cameras", {{"type", "perspective"},
                            {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}},
                            {"extensions", {{"EXT_lens", Json::object()}}}});
    file.root({{"camera", 0}});
    // Of other things, known by the list of those that the file uses.
    file.json["extensionsUsed"] = {
        "KHR_texture_transform", "KHR_texture_basisu", "KHR_materials_variants",
        "KHR_lights_punctual",   "MSFT_lod",           "KHR_materials_sheen"};
    const LeftOutOf wanted{
        {{"node", "MSFT_lod is left out"}, 1},
        {{"mesh", "EXT_some_mesh is left out"}, 1},
        {{"primitive", "KHR_materials_variants are left out but for the default material"}, 1},
        {{"scene", "EXT_lights_image_based is left out"}, 1},
        {{"camera", "EXT_lens is left out"}, 1},
        {{"file", "KHR_texture_basisu is left out"}, 1}};
    const TriangleMesh mesh = loadGlb(file);
    EXPECT_EQ(mesh.report.leftOutOf, wanted);
    EXPECT_NE(describe(mesh.report).find("; 1 mesh whose EXT_some_mesh is left out"),
              std::string::npos)
        << describe(mesh.report);
}

/// A file need not list what it uses.
TEST(GltfExtensions, ThatNoListHasAreNamedAndReadAllTheSame) {
    GltfBuilder file = squareScene();
    file.append("materials",
                {{"occlusionTexture",
                  {{"index", 0}, {"extensions", {{"EXT_of_texture_info", Json::object()}}}}},
                 {"emissiveFactor", {1, 1, 1}},
                 {"extensions",
                  {{"KHR_materials_sheen", Json::object()},
                   {"MSFT_packing", Json::object()},
                   {"KHR_materials_emissive_strength", {{"emissiveStrength", 3}}}}}});
    file.append("textures", {{"extensions", {{"EXT_of_texture", Json::object()}}}});
    file.json["meshes"][0]["primitives"][0]["material"] = 0;
    file.json["accessors"][0]["extensions"]["EXT_of_accessor"] = Json::object();
    file.json["extensions"]["EXT_of_file"] = Json::object();
    file.json["extras"]["extensions"]["EXT_of_nothing"] = Json::object();
    file.animate(0, "translation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0});
    Json& target = file.json["animations"][0]["channels"][0]["target"];
    target = {{"path", "pointer"},
              {"extensions", {{"KHR_animation_pointer", {{"pointer", "/nodes/0/translation"}}}}}};
    const LeftOutOf wanted{{{"file", "EXT_of_accessor is left out"}, 1},
                           {{"file", "EXT_of_file is left out"}, 1},
                           {{"file", "EXT_of_texture is left out"}, 1},
                           {{"file", "EXT_of_texture_info is left out"}, 1},
                           {{"file", "KHR_animation_pointer is left out"}, 1},
                           {{"file", "MSFT_packing is left out"}, 1}};
    MeshOptions options;
    options.gloss = true;
    const TriangleMesh mesh = loadGlb(file, options);
    EXPECT_EQ(mesh.report.leftOutOf, wanted) << describe(mesh.report);
    EXPECT_EQ(mesh.report.leftOut.at("KHR_materials_sheen"), 1u);
    EXPECT_EQ(mesh.materials.at(0).finish.emission, Rgb(3.0f));
}

TEST(GltfExtensions, AttributesOfAProgramsOwnAreNamed) {
    GltfBuilder file = squareScene();
    Json& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
    for (const char* name : {"_BATCHID", "COLOR_1", "TEXCOORD_1"})
        attributes[name] = attributes["POSITION"];
    const LeftOutOf wanted{{{"primitive", "attribute COLOR_1 is left out"}, 1},
                           {{"primitive", "attribute _BATCHID is left out"}, 1}};
    EXPECT_EQ(loadGlb(file).report.leftOutOf, wanted);
}

TEST(GltfNodes, RotationsThatAreNoneAreNamed) {
    GltfBuilder file = squareScene();
    file.json["nodes"][0]["rotation"] = {0, 0, 0, 0};
    const LeftOutOf wanted{{{"node", "rotation is 0, no quaternion (left out)"}, 1}};
    EXPECT_EQ(loadGlb(file).report.leftOutOf, wanted);
    file.json["nodes"][0]["rotation"] = {0, 0, 0, 2};
    EXPECT_TRUE(loadGlb(file).report.leftOutOf.empty());
}

TEST(GltfExtensions, ManyNamesAreCountedTogether) {
    GltfBuilder file = squareScene();
    for (int i = 0; i < 1000; ++i)
        file.json["meshes"][0]["extensions"][fmt::format("EXT_\n\33{}", i)] = Json::object();
    const TriangleMesh mesh = loadGlb(file);
    EXPECT_EQ(mesh.report.leftOutOf.size(), 21u);
    EXPECT_EQ(mesh.report.leftOutOf.at({"mesh", "other extension is left out"}), 980u);
    const std::string text = describe(mesh.report);
    EXPECT_LT(text.size(), 2000u);
    EXPECT_NE(text.find("EXT_??1 is left out"), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
}

TEST(GltfExtensions, PointsAndLinesAreNamed) {
    GltfBuilder file = squareScene();
    auto& primitives = file.json["meshes"][0]["primitives"];
    for (const int mode : {0, 1}) {
        primitives.push_back(primitives[0]);
        primitives.back()["mode"] = mode;
    }
    const LeftOutOf wanted{{{"primitive", "points or lines are left out"}, 2}};
    EXPECT_EQ(loadGlb(file).report.leftOutOf, wanted);
}

TEST(GltfExtensions, ThatAreReadAreNotNamed) {
    GltfBuilder file = squareScene();
    file.json["extensionsUsed"] = {"KHR_mesh_quantization", "KHR_texture_transform",
                                   "KHR_materials_ior", "EXT_mesh_gpu_instancing",
                                   "KHR_node_visibility"};
    EXPECT_TRUE(loadGlb(file).report.leftOutOf.empty());
}

/// A required extension is refused by its name, whatever else is wrong with the file.
TEST(GltfExtensions, RequiredOnesAreRefusedFirst) {
    const TemporaryFolder folder;
    GltfBuilder file = squareScene();
    file.json["extensionsRequired"] = {"KHR_mesh_quantization", "EXT_unheard_of"};
    file.json["bufferViews"][0]["byteOffset"] = 1 << 20;
    file.json["accessors"][0].erase("type");
    file.json["images"] = {{{"uri", "/etc/hostname"}}};
    for (const auto& path :
         {folder.write("a.glb", file.glb()), folder.write("a.gltf", file.gltf("missing.bin"))})
        expectError(
            [&] {
                loadMesh({&path, 1}, {});
            },
            path.filename().string(),
            "requires the extension EXT_unheard_of, which is not supported");
}

TEST(GltfExtensions, RequiredOnesThatAreReadAreNoReasonToRefuse) {
    for (const char* name :
         {"KHR_mesh_quantization", "KHR_texture_transform", "KHR_materials_pbrSpecularGlossiness",
          "KHR_materials_variants", "KHR_materials_sheen", "KHR_lights_punctual",
          "EXT_mesh_gpu_instancing", "KHR_node_visibility", "KHR_xmp_json_ld"}) {
        GltfBuilder file = squareScene();
        file.json["extensionsRequired"] = {name};
        EXPECT_EQ(loadGlb(file).triangles.size(), 2u) << name;
    }
}

TEST(GltfExtensions, HiddenNodesHideThoseBelowThem) {
    GltfBuilder file = squareScene();
    const int child = file.append("nodes", {{"mesh", 0}, {"translation", {5, 0, 0}}});
    file.root(
        {{"children", {child}}, {"extensions", {{"KHR_node_visibility", {{"visible", false}}}}}});
    EXPECT_EQ(placedCount(loadGlb(file)), 2u);
    file.json["nodes"].back()["extensions"]["KHR_node_visibility"]["visible"] = true;
    EXPECT_EQ(placedCount(loadGlb(file)), 4u);
}

TEST(GltfScenes, OtherThanTheDefaultAreNamed) {
    GltfBuilder file = squareScene();
    const int other = file.append("nodes", {{"mesh", 0}, {"translation", {5, 0, 0}}});
    EXPECT_TRUE(loadGlb(file).report.leftOutOf.empty());
    file.json["scenes"].push_back({{"nodes", {other}}});
    const LeftOutOf wanted{{{"scene", "nodes are left out, as another is the default"}, 1}};
    EXPECT_EQ(loadGlb(file).report.leftOutOf, wanted);
    EXPECT_EQ(placedCount(loadGlb(file)), 2u);
}

TEST(GltfExtensions, FilesWithoutScenesShowAllRoots) {
    GltfBuilder file = squareScene();
    const int child = file.append("nodes", {{"mesh", 0}, {"translation", {5, 0, 0}}});
    file.root({{"children", {child}}});
    file.json.erase("scene");
    file.json.erase("scenes");
    EXPECT_EQ(placedCount(loadGlb(file)), 4u);
}

}  // namespace
}  // namespace shadowcache::test
