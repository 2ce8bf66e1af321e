// What glTF's materials become.

#include <gtest/gtest.h>

#include <cmath>

#include "common/image/image.h"
#include "common/image/png.h"
#include "common/image/srgb.h"
#include "common/import/load_mesh.h"
#include "common/import/texture_decoder.h"
#include "common/mesh/looks.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

using Json = nlohmann::json;

TriangleMesh loadLooks(const GltfBuilder& file, bool gloss = true) {
    const TemporaryFolder folder;
    const auto path = folder.write("a.glb", file.glb());
    MeshOptions options;
    options.gloss = gloss;
    return loadMesh({&path, 1}, options);
}

/// The square with two sets of texture coordinates: (x, y), and the same halved.
GltfBuilder squareWith(const Json& material) {
    GltfBuilder file;
    const int positions = file.vectors(kSquare);
    const int uv = file.accessor(std::vector<float>{0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
    const int half =
        file.accessor(std::vector<float>{0, 0, 0.5f, 0, 0.5f, 0.5f, 0, 0.5f}, "VEC2", 2);
    file.append("materials", material);
    file.mesh({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uv}, {"TEXCOORD_1", half}}},
               {"indices", file.accessor(kSquareIndices, "SCALAR", 1)},
               {"material", 0}});
    file.root({{"mesh", 0}});
    return file;
}

/// A picture of 2 x 1 texels that is not filtered; texture number `n` is image `n`.
void addPicture(GltfBuilder& file, const Rgb& left, const Rgb& right) {
    const TemporaryFolder folder;
    writePng(folder.path() / "a.png", {2, 1, {left, right}}, 0);
    const int image = file.append(
        "images",
        {{"bufferView", file.view(readBytes(folder.path() / "a.png"))}, {"mimeType", "image/png"}});
    if (!file.json.contains("samplers")) file.append("samplers", {{"magFilter", 9728}});
    file.append("textures", {{"source", image}, {"sampler", 0}});
}

/// A PNG of 2 x 1 texels of 16 bits a channel: 0x8000, 0x80ff, 0xffff; 0x8140, 0x0001, 0x1234.
std::string widePng() {
    constexpr unsigned char kBytes[] = {
        0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49,
        0x48, 0x44, 0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x10, 0x02,
        0x00, 0x00, 0x00, 0x2b, 0xd0, 0x34, 0x9e, 0x00, 0x00, 0x00, 0x15, 0x49, 0x44,
        0x41, 0x54, 0x78, 0xda, 0x63, 0x68, 0x60, 0x68, 0xf8, 0xff, 0xff, 0x7f, 0xa3,
        0x03, 0x03, 0xa3, 0x90, 0x09, 0x00, 0x27, 0x96, 0x05, 0x06, 0x05, 0xae, 0x5e,
        0x99, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
    return {std::begin(kBytes), std::end(kBytes)};
}

/// At (x, y) of the square.
Surface at(const TriangleMesh& mesh, float x, float y) {
    // Of the triangles (0,0) (1,0) (1,1) and (0,0) (1,1) (0,1).
    return y <= x ? surfaceAt(mesh, 0, x - y, y, {}) : surfaceAt(mesh, 1, x, y - x, {});
}

TEST(GltfMaterial, PicturesOf16BitsKeepThem) {
    std::string cause;
    Texture wide = decodeTexture(widePng(), cause);
    ASSERT_EQ(cause, "");
    ASSERT_EQ(wide.width, 2);
    wide.smooth = false;
    const auto left = textureValue(wide, 0.25f, 0.5f), right = textureValue(wide, 0.75f, 0.5f);
    const std::array<int, 4> stored[] = {{0x8000, 0x80ff, 0xffff, 0xffff},
                                         {0x8140, 0x0001, 0x1234, 0xffff}};
    for (std::size_t c = 0; c < 4; ++c) {
        EXPECT_NEAR(left[c], static_cast<float>(stored[0][c]) / 65535.0f, 1e-7f) << c;
        EXPECT_NEAR(right[c], static_cast<float>(stored[1][c]) / 65535.0f, 1e-7f) << c;
    }
    const Rgb color = textureColor(wide, 0.25f, 0.5f);
    EXPECT_NEAR(color.x, srgbToLinear(32768.0f / 65535.0f), 1e-5f);
    EXPECT_NEAR(color.y, srgbToLinear(33023.0f / 65535.0f), 1e-5f);
    EXPECT_FLOAT_EQ(color.z, 1.0f);
    EXPECT_FLOAT_EQ(textureColor(wide, 0.75f, 0.5f).y, srgbToLinear(1.0f / 65535.0f));
    EXPECT_FLOAT_EQ(textureOpacity(wide, 0.75f, 0.5f), 1.0f);
    // Control: 8 bits cannot tell the first two apart.
    wide.low.clear();
    EXPECT_EQ(textureValue(wide, 0.25f, 0.5f)[0], textureValue(wide, 0.25f, 0.5f)[1]);
}

TEST(GltfMaterial, FactorsAreTheSpecifications) {
    const TriangleMesh mesh = loadLooks(
        squareWith({{"pbrMetallicRoughness",
                     {{"baseColorFactor", {0.5, 0.25, 1, 1}},
                      {"metallicFactor", 0.2},
                      {"roughnessFactor", 0.3}}},
                    {"emissiveFactor", {0.1, 0.2, 0.4}},
                    {"extensions",
                     {{"KHR_materials_ior", {{"ior", 2}}},
                      {"KHR_materials_specular",
                       {{"specularFactor", 0.5}, {"specularColorFactor", {1, 0.5, 100}}}},
                      {"KHR_materials_emissive_strength", {{"emissiveStrength", 10}}}}}}));
    const Surface s = at(mesh, 0.6f, 0.2f);
    EXPECT_TRUE(s.glossy);
    EXPECT_FLOAT_EQ(s.roughness, 0.3f);
    EXPECT_FLOAT_EQ(s.diffuse.x, 0.8f * 0.5f);
    EXPECT_FLOAT_EQ(s.f0.x, 0.8f * 0.5f / 9 + 0.2f * 0.5f);
    EXPECT_FLOAT_EQ(s.f0.y, 0.8f * 0.25f / 9 + 0.2f * 0.25f);
    EXPECT_FLOAT_EQ(s.f0.z, 0.8f * 0.5f + 0.2f);  // no more than the strength
    EXPECT_FLOAT_EQ(s.f90.x, 0.8f * 0.5f + 0.2f);
    EXPECT_FLOAT_EQ(s.loss0, 0.5f);
    EXPECT_FLOAT_EQ(s.loss90, 0.5f);
    EXPECT_FLOAT_EQ(s.emission.z, 4.0f);
    EXPECT_TRUE(mesh.report.leftOut.empty());
}

TEST(GltfMaterial, WithoutFactorsIsARoughMetal) {
    const Surface s = at(loadLooks(squareWith(Json::object())), 0.6f, 0.2f);
    EXPECT_TRUE(s.glossy);
    EXPECT_EQ(s.roughness, 1);
    EXPECT_EQ(s.diffuse, Rgb(0.0f));
    EXPECT_EQ(s.f0, Rgb(1.0f));
}

TEST(GltfMaterial, IsLambertianWhereGlossIsNotRead) {
    const GltfBuilder file = squareWith(
        {{"emissiveFactor", {1, 1, 1}}, {"pbrMetallicRoughness", {{"metallicFactor", 0.5}}}});
    const Surface s = at(loadLooks(file, false), 0.6f, 0.2f);
    EXPECT_FALSE(s.glossy);
    EXPECT_EQ(s.diffuse, Rgb(1.0f));
    EXPECT_EQ(s.emission, Rgb(0.0f));
}

TEST(GltfMaterial, FactorsOutOfRangeAreBroughtIntoIt) {
    const TriangleMesh mesh = loadLooks(
        squareWith({{"pbrMetallicRoughness", {{"metallicFactor", -3}, {"roughnessFactor", 1e9}}},
                    {"extensions",
                     {{"KHR_materials_ior", {{"ior", 0.2}}},
                      {"KHR_materials_specular", {{"specularFactor", 7}}}}}}));
    const Surface s = at(mesh, 0.6f, 0.2f);
    EXPECT_EQ(s.roughness, 1);
    EXPECT_EQ(s.diffuse, Rgb(1.0f));
    EXPECT_EQ(s.f0, Rgb(0.0f));  // an index of refraction of 1
    EXPECT_EQ(s.f90, Rgb(1.0f));
}

TEST(GltfMaterial, LightThatIsLessThanNoneOrEndlessIsRefused) {
    const auto refused = [](const nlohmann::json& material, const char* cause) {
        expectError([&] { loadLooks(squareWith(material)); }, "material 0", cause);
    };
    const auto strength = [](double s) {
        return nlohmann::json{
            {"emissiveFactor", {1, 1, 0}},
            {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", s}}}}}};
    };
    refused({{"emissiveFactor", {-1, 1, 0}}}, "expected three numbers of 0 to 1e+15");
    refused({{"emissiveFactor", {1, 1e300, 0}}}, "expected three numbers of 0 to 1e+15");
    refused(strength(-5), "emissiveStrength -5.0, expected 0 to 1e+15");
    refused(strength(1e39), "emissiveStrength 1e+39");
    EXPECT_EQ(at(loadLooks(squareWith(strength(1e15))), 0.6f, 0.2f).emission.x, 1e15f);
}

TEST(GltfMaterial, AnIndexOfRefractionOfZeroReflectsEverything) {
    const TriangleMesh mesh =
        loadLooks(squareWith({{"pbrMetallicRoughness", {{"metallicFactor", 0}}},
                              {"extensions", {{"KHR_materials_ior", {{"ior", 0}}}}}}));
    EXPECT_EQ(at(mesh, 0.6f, 0.2f).f0, Rgb(1.0f));
}

TEST(GltfMaterial, UnlitEmitsItsColor) {
    const TriangleMesh mesh =
        loadLooks(squareWith({{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 1, 1}}}},
                              {"emissiveFactor", {1, 1, 1}},
                              {"extensions", {{"KHR_materials_unlit", Json::object()}}}}));
    const Surface s = at(mesh, 0.6f, 0.2f);
    EXPECT_TRUE(s.unlit);
    EXPECT_FALSE(s.glossy);
    EXPECT_EQ(s.emission, Rgb(0.5f, 0.25f, 1));
    EXPECT_EQ(s.diffuse, Rgb(0.0f));
}

// Green is roughness, blue metalness, both linear; colours are sRGB.
TEST(GltfMaterial, TexturesOfEverySlot) {
    GltfBuilder file = squareWith({{"pbrMetallicRoughness",
                                    {{"metallicFactor", 0.5},
                                     {"roughnessFactor", 0.8},
                                     {"metallicRoughnessTexture", {{"index", 0}}}}},
                                   {"emissiveFactor", {1, 1, 1}},
                                   {"emissiveTexture", {{"index", 1}}}});
    // Written as sRGB: 0.5 is stored as 188 of 255.
    addPicture(file, Rgb(1, 0.5f, 0), Rgb(0, 0, 1));
    addPicture(file, Rgb(0.5f, 0.25f, 0), Rgb(0, 0, 1));
    const TriangleMesh mesh = loadLooks(file);
    const Surface left = at(mesh, 0.3f, 0.2f), right = at(mesh, 0.7f, 0.2f);
    EXPECT_FLOAT_EQ(left.roughness, 0.8f * 188 / 255);
    EXPECT_EQ(left.f90, Rgb(1.0f));
    EXPECT_EQ(left.diffuse, Rgb(1.0f));
    EXPECT_EQ(right.roughness, 0);
    EXPECT_FLOAT_EQ(right.diffuse.x, 0.5f);
    EXPECT_NEAR(left.emission.x, 0.5, 0.005);
    EXPECT_EQ(right.emission, Rgb(0, 0, 1));
}

// The base colour by the first set of coordinates, roughness by the second, emission by the first
// and shifted.
TEST(GltfMaterial, SlotsHaveTexturePlacesOfTheirOwn) {
    const Json moved{{"index", 0},
                     {"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 0}}}}}}};
    GltfBuilder file =
        squareWith({{"pbrMetallicRoughness",
                     {{"metallicFactor", 0},
                      {"baseColorTexture", {{"index", 0}}},
                      {"metallicRoughnessTexture", {{"index", 0}, {"texCoord", 1}}}}},
                    {"emissiveFactor", {1, 1, 1}},
                    {"emissiveTexture", moved}});
    addPicture(file, Rgb(1, 0, 0), Rgb(0, 1, 0));
    // A mesh without such a material comes after it.
    file.json["meshes"].push_back(file.json["meshes"][0]);
    file.json["meshes"][1]["primitives"][0].erase("material");
    file.root({{"mesh", 1}, {"translation", {5, 0, 0}}});
    const TriangleMesh mesh = loadLooks(file);
    ASSERT_EQ(mesh.moreTexcoords.size(), 2u);
    for (const auto& layer : mesh.moreTexcoords) EXPECT_EQ(layer.size(), mesh.positions.size());
    // The square without material comes first.
    const auto surface = [&](float x, float y) { return surfaceAt(mesh, 2, x - y, y, {}); };
    EXPECT_EQ(surface(0.7f, 0.2f).baseColor, Rgb(0, 1, 0));
    EXPECT_EQ(surface(0.7f, 0.2f).roughness, 0);  // at 0.35: the left texel
    EXPECT_EQ(surface(0.7f, 0.2f).emission, Rgb(1, 0, 0));
    EXPECT_EQ(surface(0.3f, 0.2f).emission, Rgb(0, 1, 0));
}

TEST(GltfMaterial, SpecularTextures) {
    const Json both{{"specularTexture", {{"index", 0}}}, {"specularColorTexture", {{"index", 0}}}};
    GltfBuilder file = squareWith({{"pbrMetallicRoughness", {{"metallicFactor", 0}}},
                                   {"extensions", {{"KHR_materials_specular", both}}}});
    addPicture(file, Rgb(1, 0, 0), Rgb(0, 1, 0));
    const Surface s = at(loadLooks(file), 0.3f, 0.2f);
    EXPECT_FLOAT_EQ(s.f0.x, 0.04f);
    EXPECT_EQ(s.f0.y, 0);
    EXPECT_EQ(s.f90.y, 1);
}

/// A PNG of 2 x 1 texels: red with an opacity of 0.2, opaque green.
std::string pngWithOpacity() {
    constexpr unsigned char kBytes[] = {
        0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44,
        0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x06, 0x00, 0x00, 0x00, 0xf4,
        0x22, 0x7f, 0x8a, 0x00, 0x00, 0x00, 0x11, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0xf8,
        0xcf, 0xc0, 0x60, 0xcc, 0xf0, 0x9f, 0xe1, 0x3f, 0x00, 0x0c, 0xfc, 0x03, 0x31, 0x7e, 0x33,
        0x77, 0xee, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
    return {std::begin(kBytes), std::end(kBytes)};
}

TEST(GltfMaterial, SpecularGlossinessIsRead) {
    const Json older{{"diffuseFactor", {0.5, 0.25, 1, 0.75}},
                     {"specularFactor", {0.04, 0.2, 0}},
                     {"glossinessFactor", 0.75}};
    // What is stated beside it counts for readers that do not know it.
    Json material{{"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0, 1}}}},
                  {"alphaMode", "BLEND"},
                  {"extensions", {{"KHR_materials_pbrSpecularGlossiness", older}}}};
    const TriangleMesh mesh = loadLooks(squareWith(material));
    EXPECT_TRUE(mesh.report.leftOut.empty());
    EXPECT_EQ(mesh.materials[0].opacity, 0.75f);
    const Surface s = at(mesh, 0.3f, 0.2f);
    EXPECT_EQ(s.baseColor, Rgb(0.5f, 0.25f, 1));
    EXPECT_EQ(s.roughness, 0.25f);
    EXPECT_FLOAT_EQ(s.f0.x, 0.04f);
    EXPECT_FLOAT_EQ(s.f0.y, 0.2f);
    EXPECT_EQ(s.f0.z, 0);
    EXPECT_EQ(s.f90.x, 1);
    // Without numbers all of them are 1.
    material["extensions"]["KHR_materials_pbrSpecularGlossiness"] = Json::object();
    EXPECT_EQ(at(loadLooks(squareWith(material)), 0.3f, 0.2f).f0, Rgb(1.0f));
    EXPECT_EQ(at(loadLooks(squareWith(material)), 0.3f, 0.2f).roughness, 0);
}

TEST(GltfMaterial, SpecularGlossinessHasTextures) {
    const Json older{{"diffuseTexture", {{"index", 0}}},
                     {"specularFactor", {0.5, 0.5, 0.5}},
                     {"glossinessFactor", 0.5},
                     {"specularGlossinessTexture", {{"index", 1}}}};
    GltfBuilder file =
        squareWith({{"extensions", {{"KHR_materials_pbrSpecularGlossiness", older}}}});
    addPicture(file, Rgb(0, 0, 1), Rgb(1, 1, 1));
    const int image = file.append(
        "images", {{"bufferView", file.view(pngWithOpacity())}, {"mimeType", "image/png"}});
    file.append("textures", {{"source", image}, {"sampler", 0}});
    const TriangleMesh mesh = loadLooks(file);
    const Surface left = at(mesh, 0.3f, 0.2f), right = at(mesh, 0.8f, 0.2f);
    EXPECT_EQ(left.baseColor, Rgb(0, 0, 1));
    EXPECT_EQ(left.f0, Rgb(0.5f, 0, 0));
    EXPECT_EQ(right.f0, Rgb(0, 0.5f, 0));
    // 1 - 0.5 times the opacity, in steps of 1/255.
    EXPECT_NEAR(left.roughness, 0.9f, 0.51f / 255);
    EXPECT_NEAR(right.roughness, 0.5f, 0.51f / 255);
    // Diffuse surfaces keep the base colour alone.
    EXPECT_EQ(at(loadLooks(file, false), 0.3f, 0.2f).diffuse, Rgb(0, 0, 1));
}

/// Smooth glass.
Json pane(const Json& transmission, Json more = Json::object()) {
    more["KHR_materials_transmission"] = transmission;
    return {{"pbrMetallicRoughness",
             {{"baseColorFactor", {0.5, 1, 1, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 0}}},
            {"extensions", more}};
}

TEST(GltfMaterial, TransmissionTintsWhatPasses) {
    GltfBuilder file =
        squareWith(pane({{"transmissionFactor", 0.8}, {"transmissionTexture", {{"index", 0}}}}));
    addPicture(file, {1, 0, 0}, {0, 1, 1});
    file.json["extensionsRequired"] = {"KHR_materials_transmission"};
    const TriangleMesh mesh = loadLooks(file);
    EXPECT_TRUE(mesh.report.leftOut.empty());
    EXPECT_TRUE(mesh.materials[0].doubleSided);
    const Surface left = at(mesh, 0.3f, 0.2f), right = at(mesh, 0.8f, 0.2f);
    EXPECT_EQ(left.transmitted, Rgb(0.4f, 0.8f, 0.8f));
    EXPECT_EQ(left.diffuse, Rgb(0.5f, 1, 1) * (1 - 0.8f));
    EXPECT_EQ(right.transmitted, Rgb(0));
    EXPECT_EQ(right.diffuse, Rgb(0.5f, 1, 1));
    const Passage passage = passageAt(mesh, mesh.materials[0], 0, 0.1f, 0.2f, 1);
    const float wanted = 0.96f * luminance(left.transmitted);
    EXPECT_NEAR(1 - passage.stopped, wanted, 1e-5f);
    EXPECT_NEAR(passage.tint.x * wanted, 0.96f * 0.4f, 1e-5f);
    // Panes are panes where surfaces are diffuse, too.
    EXPECT_EQ(at(loadLooks(file, false), 0.3f, 0.2f).transmitted, left.transmitted);
}

TEST(GltfMaterial, OpacityCoversWhatTransmits) {
    Json material = pane({{"transmissionFactor", 1}});
    material["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.25};
    material["alphaMode"] = "BLEND";
    const TriangleMesh mesh = loadLooks(squareWith(material));
    const Passage passage = passageAt(mesh, mesh.materials[0], 0, 0.1f, 0.2f, -1);
    EXPECT_NEAR(passage.stopped, 0.25f * 0.04f, 1e-6f);
    EXPECT_NEAR(passage.weight, 1 / 0.04f, 1e-2f);
}

TEST(GltfMaterial, TransmissionOutOfRangeIsClamped) {
    for (const auto& [factor, wanted] : {std::pair(7.0, 1.0f), {-1.0, 0.0f}}) {
        const TriangleMesh mesh = loadLooks(squareWith(pane({{"transmissionFactor", factor}})));
        EXPECT_EQ(mesh.materials[0].finish.transmission, wanted);
        EXPECT_EQ(mesh.report.remarks.size(), 1u);
        EXPECT_EQ(mesh.materials[0].isPane(), wanted > 0);
    }
}

TEST(GltfMaterial, WhatIsNoPaneIsNamed) {
    using LeftOut = std::map<std::string, std::size_t>;
    const Json clear{{"transmissionFactor", 1}};
    EXPECT_EQ(loadLooks(squareWith(pane(clear, {{"KHR_materials_volume", Json::object()}})))
                  .report.leftOut,
              (LeftOut{{"volume of glass (rendered as panes)", 1}}));
    Json frosted = pane(clear);
    frosted["pbrMetallicRoughness"]["roughnessFactor"] = 0.5;
    EXPECT_EQ(loadLooks(squareWith(frosted)).report.leftOut,
              (LeftOut{{"blur by rough glass (light passes straight)", 1}}));
    EXPECT_EQ(loadLooks(squareWith(pane(
                            {{"transmissionFactor", 1}, {"transmissionTexture", Json::object()}})))
                  .report.leftOut,
              (LeftOut{{"transmissionTexture", 1}}));
    EXPECT_EQ(loadLooks(squareWith(
                            pane(clear, {{"KHR_materials_pbrSpecularGlossiness", Json::object()}})))
                  .report.leftOut,
              (LeftOut{{"KHR_materials_transmission", 1}}));
}

TEST(GltfMaterial, WhatIsLeftOutIsCounted) {
    const Json material{{"extensions",
                         {{"KHR_materials_clearcoat", {{"clearcoatFactor", 1}}},
                          {"KHR_materials_iridescence", {{"iridescenceFactor", 1}}}}}};
    GltfBuilder file = squareWith(material);
    file.append("materials", material);
    file.append("materials", material);  // which nothing has
    file.json["meshes"].push_back(file.json["meshes"][0]);
    file.json["meshes"][1]["primitives"][0]["material"] = 1;
    file.root({{"mesh", 1}, {"translation", {5, 0, 0}}});
    file.json["extensionsRequired"] = {"KHR_materials_iridescence"};
    const TriangleMesh mesh = loadLooks(file);
    const std::map<std::string, std::size_t> wanted{{"KHR_materials_clearcoat", 2},
                                                    {"KHR_materials_iridescence", 2}};
    EXPECT_EQ(mesh.report.leftOut, wanted);
    EXPECT_NE(describe(mesh.report)
                  .find("2 materials without their KHR_materials_clearcoat, which is left out"),
              std::string::npos);
}

TEST(GltfMaterial, MissingTexturesAreRefused) {
    const TemporaryFolder folder;
    const auto refuse = [&](const Json& material, const char* cause) {
        const auto path = folder.write("a.glb", squareWith(material).glb());
        expectError([&] { loadMesh({&path, 1}, {}); }, "a.glb", cause);
    };
    refuse({{"name", "brass"},
            {"pbrMetallicRoughness", {{"metallicRoughnessTexture", {{"index", 3}}}}}},
           "material 0 (brass): pbrMetallicRoughness: metallicRoughnessTexture: texture 3");
    refuse(pane({{"transmissionFactor", 1}, {"transmissionTexture", {{"index", 3}}}}),
           "KHR_materials_transmission: transmissionTexture: texture 3");
    // One without a number is left out.
    const TriangleMesh bare = loadLooks(squareWith(
        {{"extensions", {{"KHR_materials_specular", {{"specularTexture", {{"texCoord", 1}}}}}}}}));
    EXPECT_EQ(bare.report.leftOut.at("specularTexture"), 1u);
    GltfBuilder file =
        squareWith({{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", {{"index", 0}}}});
    file.append("images", {{"uri", "lamp.png"}});
    file.append("textures", {{"source", 0}});
    // Without its picture it would shine all over.
    const TriangleMesh dark = loadLooks(file);
    EXPECT_EQ(dark.report.leftOutOf.at(
                  {"texture", "picture was not found (left out): image 0 (lamp.png)"}),
              1u);
    EXPECT_EQ(at(dark, 0.3f, 0.2f).emission, Rgb(0.0f));
}

TEST(GltfMaterial, ADamagedPictureLeavesItsTextureOut) {
    const auto square = [](const std::string& picture) {
        GltfBuilder file = squareWith(
            {{"pbrMetallicRoughness",
              {{"baseColorFactor", {0.5, 1, 0.25, 1}}, {"baseColorTexture", {{"index", 0}}}}}});
        const int image =
            file.append("images", {{"bufferView", file.view(picture)}, {"mimeType", "image/png"}});
        file.append("textures", {{"source", image}});
        return loadLooks(file);
    };
    const std::string whole = pngWithOpacity();
    for (const std::string& damaged : {whole.substr(0, 40), std::string("no picture at all")}) {
        const TriangleMesh mesh = square(damaged);
        ASSERT_EQ(mesh.report.leftOutOf.size(), 1u);
        EXPECT_NE(describe(mesh.report).find("1 texture whose picture "), std::string::npos)
            << describe(mesh.report);
        EXPECT_EQ(at(mesh, 0.3f, 0.2f).baseColor, Rgb(0.5f, 1, 0.25f));
    }
    // The control: the whole one counts.
    EXPECT_TRUE(square(whole).report.leftOutOf.empty());
    EXPECT_EQ(at(square(whole), 0.25f, 0.2f).baseColor, Rgb(0.5f, 0, 0));
}

TEST(GltfMaterial, TextsThatAreNoUtf8AreMended) {
    GltfBuilder file = squareWith({{"name", "NAME"}});
    std::string bytes = file.glb();
    const TemporaryFolder folder;
    const auto load = [&](const char* name) {
        std::string changed = bytes;
        changed.replace(changed.find("NAME"), 4, name, 4);
        const auto path = folder.write("a.glb", changed);
        return loadMesh({&path, 1}, {});
    };
    const std::pair<std::string, std::string> mended{
        "file", "texts are not UTF-8 (such bytes are replaced)"};
    // Latin-1, cut short, longer than need be, a surrogate, beyond Unicode.
    for (const char* name :
         {"caf\xe9", "abc\xc3", "ab\xc0\xaf", "a\xed\xa0\x80", "\xf4\x90\x80\x80"}) {
        const TriangleMesh mesh = load(name);
        EXPECT_EQ(mesh.report.triangles, 2u);
        EXPECT_EQ(mesh.report.leftOutOf.count(mended), 1u) << name;
    }
    for (const char* name : {"ab\xc3\xa9", "\xf0\x9f\x8e\xa5", "a\xe2\x82\xac"})
        EXPECT_TRUE(load(name).report.leftOutOf.empty()) << name;
}

}  // namespace
}  // namespace shadowcache::test
