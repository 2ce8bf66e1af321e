// Colours of every format and type, of OFF's faces too, decided for a file as a whole; bad ones
// are counted.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/image/srgb.h"
#include "common/import/load_mesh.h"
#include "common/mesh/looks.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/loaded_mesh.h"
#include "tests/support/mesh_files.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

TriangleMesh loadCase(const std::string& name) {
    return loadFile(std::filesystem::path(SHADOWCACHE_CASES) / name);
}

void expectVertexColor(const Rgb& found, const Rgb& wanted) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], wanted[k], 5e-4f) << found << wanted;
}

TEST(ColorCases, HaveTheirValues) {
    const Rgb orange(1, 0.503f, 0);
    for (const char* name :
         {"colors_of_type_int.ply", "colors_of_type_uchar.ply", "colors_to_255.obj"}) {
        const TriangleMesh mesh = loadCase(name);
        for (const Rgb& color : mesh.colors) expectVertexColor(color, orange);
        EXPECT_EQ(mesh.report.badColors, 0u) << name;
    }
    for (const char* name : {"colors_by_blender.obj", "colors_by_blender.glb"})
        for (const Rgb& color : loadCase(name).colors) expectVertexColor(color, Rgb(0.214f));
    const TriangleMesh coff = loadCase("colors_with_and_without_point.off");
    expectVertexColor(coff.colors.at(0), {1, 0, 0});
    expectVertexColor(coff.colors.at(3), {1, 0.214f, 0});

    const TriangleMesh nan = loadCase("colors_not_a_number.obj");
    EXPECT_EQ(nan.report.badColors, 1u);
    EXPECT_EQ(nan.colors.at(3), Rgb(0.0f));
    expectVertexColor(nan.colors.at(0), Rgb(0.214f));
    EXPECT_NE(describe(nan.report).find("1 vertex colours out of range or not finite, clamped"),
              std::string::npos);
}

/// The colours of a triangle in each text format that has some.
TriangleMesh triangle(const std::string& format, const std::array<std::string, 3>& colors,
                      const std::string& type = "float") {
    std::string rows;
    for (int i = 0; i < 3; ++i)
        rows += fmt::format("{}{} {} 0 {}\n", format == "obj" ? "v " : "", i, i * i,
                            colors[static_cast<std::size_t>(i)]);
    if (format == "obj") return loadBytes("a.obj", rows + "f 1 2 3\n");
    if (format == "off") return loadBytes("a.off", "COFF\n3 1 0\n" + rows + "3 0 1 2\n");
    std::string head = "ply\nformat ascii 1.0\nelement vertex 3\n";
    for (const char* axis : {"x", "y", "z"}) head += std::string("property float ") + axis + "\n";
    for (const char* name : {"red", "green", "blue"})
        head += "property " + type + " " + name + "\n";
    return loadBytes("a.ply", head +
                                  "element face 1\nproperty list uchar int vertex_indices\n"
                                  "end_header\n" +
                                  rows + "3 0 1 2\n");
}

void expectColors(const TriangleMesh& mesh, const std::array<Rgb, 3>& wanted, std::size_t bad = 0) {
    ASSERT_EQ(mesh.colors.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) expectVertexColor(mesh.colors[i], wanted[i]);
    EXPECT_EQ(mesh.report.badColors, bad);
}

/// A display's number, made linear.
Rgb shown(float r, float g, float b) {
    return {srgbToLinear(r), srgbToLinear(g), srgbToLinear(b)};
}

TEST(ColorNumbers, AreThoseOfTheWholeFile) {
    for (const std::string format : {"obj", "off", "ply"}) {
        SCOPED_TRACE(format);
        // 0 to 1 if one is no whole number, or none is above 1.
        expectColors(triangle(format, {"1 0 0", "0 1 0", "0.5 0 1"}),
                     {shown(1, 0, 0), shown(0, 1, 0), shown(0.5f, 0, 1)});
        expectColors(triangle(format, {"1 0 0", "0 1 0", "1 1 1.0"}),
                     {shown(1, 0, 0), shown(0, 1, 0), shown(1, 1, 1)});
        // 0 to 255 otherwise, and so for those that are 0 and 1, too.
        expectColors(triangle(format, {"1 0 0", "0 1 0", "255 51 2e1"}),
                     {shown(1 / 255.f, 0, 0), shown(0, 1 / 255.f, 0), shown(1, 0.2f, 20 / 255.f)});
        // Out of range: of either kind.
        expectColors(triangle(format, {"1.5 0 0", "0 -1 0", "0.5 inf 1"}),
                     {shown(1, 0, 0), shown(0, 0, 0), shown(0.5f, 1, 1)}, 3);
        expectColors(triangle(format, {"256 0 0", "0 -1 0", "nan 2 255"}),
                     {shown(1, 0, 0), shown(0, 0, 0), shown(0, 2 / 255.f, 1)}, 3);
        expectColors(triangle(format, {"1e999 0 0", "0 -1e999 0", "0.5 0 0"}),
                     {shown(1, 0, 0), shown(0, 0, 0), shown(0.5f, 0, 0)}, 2);
    }
}

TEST(ColorNumbers, AreTakenByTheirTypeInPly) {
    const float one = 1 / 255.f;
    for (const std::string type : {"uchar", "uint8"})
        expectColors(triangle("ply", {"1 0 0", "0 1 0", "0 0 1"}, type),
                     {shown(one, 0, 0), shown(0, one, 0), shown(0, 0, one)});
    for (const std::string type : {"ushort", "short", "int", "uint"}) {
        expectColors(triangle("ply", {"1 0 0", "0 255 0", "0 0 51"}, type),
                     {shown(one, 0, 0), shown(0, 1, 0), shown(0, 0, 0.2f)});
        expectColors(triangle("ply", {"1 0 0", "0 255 0", "0 0 13107"}, type),
                     {shown(1 / 65535.f, 0, 0), shown(0, 255 / 65535.f, 0), shown(0, 0, 0.2f)});
    }
    expectColors(triangle("ply", {"-1 0 0", "0 70000 0", "0 0 65535"}, "int"),
                 {shown(0, 0, 0), shown(0, 1, 0), shown(0, 0, 1)}, 2);
    expectColors(triangle("ply", {"1 0 0", "0 0.5 0", "0 0 1"}, "double"),
                 {shown(1, 0, 0), shown(0, 0.5f, 0), shown(0, 0, 1)});
}

TEST(ColorNumbers, OfOffAreToldByTheirOpacityToo) {
    // 0 and 1 of 255, and of 1.
    const float one = 1 / 255.f;
    expectColors(triangle("off", {"1 0 0 255", "0 1 0 255", "0 0 1 255"}),
                 {shown(one, 0, 0), shown(0, one, 0), shown(0, 0, one)});
    expectColors(triangle("off", {"1 0 0 1", "0 1 0 1", "0 0 1 0.5"}),
                 {shown(1, 0, 0), shown(0, 1, 0), shown(0, 0, 1)});
    // Opacity is not read: it is never out of range.
    expectColors(triangle("off", {"1 0 0 9.5", "0 1 0 1", "0 0 1 1"}),
                 {shown(1, 0, 0), shown(0, 1, 0), shown(0, 0, 1)});
}

TEST(ColorNumbers, OfVerticesWithoutOneAreWhite) {
    expectColors(triangle("obj", {"255 0 0", "", "0 51 0"}),
                 {shown(1, 0, 0), shown(1, 1, 1), shown(0, 0.2f, 0)});
}

/// Of two faces of a square, whose colours follow its corners; and what is said.
std::pair<TriangleMesh, std::string> colored(const std::string& first, const std::string& second,
                                             const std::string& magic = "OFF") {
    const std::string end = magic == "COFF" ? " 0 0 255 255\n" : "\n";
    std::string rows;
    for (const char* corner : {"0 0 0", "1 0 0", "1 1 0", "0 1 0"}) rows += corner + end;
    TriangleMesh mesh = loadBytes(
        "a.off", magic + "\n4 2 0\n" + rows + "3 0 1 2 " + first + "\n3 0 2 3 " + second + "\n");
    std::string said = describe(mesh.report);
    return {std::move(mesh), std::move(said)};
}

void expectFaces(const TriangleMesh& mesh, const Rgb& first, const Rgb& second) {
    ASSERT_EQ(mesh.triangles.size(), 2u);
    ASSERT_FALSE(mesh.colors.empty());
    for (int k = 0; k < 3; ++k) {
        expectVertexColor(mesh.colors[static_cast<std::size_t>(mesh.triangles[0][k])], first);
        expectVertexColor(mesh.colors[static_cast<std::size_t>(mesh.triangles[1][k])], second);
    }
}

TEST(FaceColors, OfOffAreRead) {
    expectFaces(colored("255 0 0", "0 51 0 255").first, {1, 0, 0}, shown(0, 0.2f, 0));
    expectFaces(colored("1.0 0 0", "0 0.2 0 1").first, {1, 0, 0}, shown(0, 0.2f, 0));
    // A face without is white beside one with, and black is a colour.
    expectFaces(colored("0 0 0", "# none").first, Rgb(0.0f), Rgb(1.0f));
    const auto [bad, said] = colored("300 0 0", "0 nan 255");
    expectFaces(bad, {1, 0, 0}, {0, 0, 1});
    EXPECT_EQ(bad.report.badColors, 2u);
    EXPECT_EQ(colored("", "").second, "2 triangles");
}

/// A number beyond the vertices of the file is not that of a vertex that was split.
TEST(FaceColors, LeaveBadCornersBad) {
    const TriangleMesh mesh = loadBytes("a.off",
                                        "OFF\n4 3 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 255 0 0\n"
                                        "3 0 2 3 0 255 0\n3 0 1 5 0 0 255\n");
    EXPECT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(mesh.report.badVertexFaces, 1u) << describe(mesh.report);
}

TEST(FaceColors, OfOffThatAreLeftOutAreSaid) {
    const auto [numbers, said] = colored("7", "7");
    EXPECT_TRUE(numbers.colors.empty());
    EXPECT_NE(said.find("2 faces whose colours are left out"), std::string::npos) << said;
    const auto [both, saidOfBoth] = colored("255 0 0", "255 0 0", "COFF");
    expectFaces(both, {0, 0, 1}, {0, 0, 1});
    EXPECT_NE(saidOfBoth.find("colours of the faces"), std::string::npos) << saidOfBoth;
}

/// Albedo of a triangle, of a set where `.3` is what has no colour of its own.
Rgb albedoOf(const TriangleMesh& mesh, std::uint32_t triangle) {
    return albedoAt(mesh, triangle, 0.25f, 0.25f, Rgb(0.3f));
}

// Each file tells about its own surfaces alone, whichever comes first.
TEST(UncoloredFiles, StayWithoutColorBesideOthers) {
    const TemporaryFolder folder;
    const auto plain = folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n");
    const auto red =
        folder.write("b.obj", "v 2 0 0 1.0 0 0\nv 3 0 0 1 0 0\nv 2 0 1 1 0 0\nf 1 2 3\n");
    const std::vector<std::filesystem::path> orders[] = {{plain, red}, {red, plain}};
    for (std::uint32_t k = 0; k < 2; ++k) {
        const TriangleMesh mesh = loadMesh(orders[k], {});
        EXPECT_EQ(albedoOf(mesh, k), Rgb(0.3f));
        EXPECT_EQ(albedoOf(mesh, 1 - k), Rgb(1, 0, 0));
    }
}

// And so does each primitive of glTF; one with a material has its colour.
TEST(UncoloredFiles, AreLikeUncoloredPrimitives) {
    GltfBuilder file = squareGltf();
    const nlohmann::json plain = file.json["meshes"][0]["primitives"][0];
    nlohmann::json red = plain, blue = plain;
    red["attributes"]["COLOR_0"] = file.vectors({1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0});
    blue["material"] =
        file.append("materials", {{"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 1, 1}}}}});
    file.json["meshes"][0]["primitives"] = {plain, red, blue};
    file.root({{"mesh", 0}});
    const TriangleMesh mesh = loadBytes("a.glb", file.glb());
    ASSERT_EQ(mesh.triangles.size(), 6u);
    EXPECT_EQ(albedoOf(mesh, 0), Rgb(0.3f));
    EXPECT_EQ(albedoOf(mesh, 2), Rgb(1, 0, 0));
    EXPECT_EQ(albedoOf(mesh, 4), Rgb(0, 0, 1));
}

TEST(ColorNumbers, OfGltfAreLinearAndClamped) {
    GltfBuilder file = squareGltf();
    file.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
        file.vectors({0.5f, 0, 1, 2, 0, 0, 0, -1, 0, 0, 0, 0.25f});
    file.root({{"mesh", 0}});
    const TriangleMesh mesh = loadBytes("a.glb", file.glb());
    EXPECT_EQ(mesh.report.badColors, 2u);
    EXPECT_EQ(mesh.colors.at(0), Rgb(0.5f, 0, 1));
    EXPECT_EQ(mesh.colors.at(1), Rgb(1, 0, 0));
    EXPECT_EQ(mesh.colors.at(2), Rgb(0, 0, 0));
}

}  // namespace
}  // namespace shadowcache::test
