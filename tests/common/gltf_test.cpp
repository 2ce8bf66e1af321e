// Every kind of mesh, accessor, material and animation; mirrored nodes keep their sides; all
// kinds of rays pass through holes.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "common/image/image.h"
#include "common/image/png.h"
#include "common/import/gltf_mesh.h"
#include "common/import/gltf_nodes.h"
#include "common/import/load_mesh.h"
#include "common/mesh/looks.h"
#include "common/mesh/mesh_fingerprint.h"
#include "common/mesh/placed_mesh.h"
#include "common/trace/scene.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/loaded_mesh.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

using Json = nlohmann::json;

double area(const TriangleMesh& mesh) {
    double sum = 0;
    for (std::uint32_t i = 0; i < placedCount(mesh); ++i) {
        const auto [a, b, c] = placedCorners(mesh, i);
        sum += (b - a).cross(c - a).length() / 2;
    }
    return sum;
}

/// A ray along -z or +z at (x, y), from 10 before the set's middle plane.
Hit look(const Scene& scene, double x, double y, double towards = -1) {
    const Vec3d from = Vec3d(x, y, -10 * towards) - scene.mesh().origin;
    return scene.intersect(Vec3f(from), Vec3f(0, 0, static_cast<float>(towards)));
}

bool open(const Scene& scene, double x, double y, double towards = -1) {
    RayPacket packet{};
    packet.set(0, Vec3f(Vec3d(x, y, -10 * towards) - scene.mesh().origin),
               Vec3f(0, 0, static_cast<float>(towards)));
    RayStream stream{};
    for (int k = 0; k < 3; ++k) {
        stream.origin[k][0] = Vec3f(Vec3d(x, y, -10 * towards) - scene.mesh().origin)[k];
        stream.direction[k][0] = k == 2 ? static_cast<float>(towards) : 0;
    }
    stream.reach[0] = std::numeric_limits<float>::infinity();
    scene.trace(stream, 1);
    float distance = 0;
    scene.distances(packet, 1, &distance);
    const bool seen = scene.visibility(packet, 1) == 1;
    EXPECT_EQ(seen, stream.reach[0] >= 0);
    EXPECT_EQ(seen, std::isinf(distance));
    return seen;
}

/// A PNG of 2 x 1 texels as an image of the file.
int addPicture(GltfBuilder& file, const std::string& png) {
    const int image =
        file.append("images", {{"bufferView", file.view(png)}, {"mimeType", "image/png"}});
    return file.append("textures", {{"source", image}, {"sampler", 0}});
}

std::string twoTexels(const Rgb& left, const Rgb& right) {
    const TemporaryFolder folder;
    writePng(folder.path() / "a.png", {2, 1, {left, right}}, 0);
    return readBytes(folder.path() / "a.png");
}

/// The square with texture coordinates (x, y) and a material.
GltfBuilder texturedSquare(const Json& texture, const Json& material) {
    GltfBuilder file;
    const int positions = file.vectors(kSquare);
    const int uv = file.accessor(std::vector<float>{0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
    const int indices = file.accessor(kSquareIndices, "SCALAR", 1);
    file.append("samplers", {{"magFilter", 9728}, {"wrapS", 10497}, {"wrapT", 33071}});
    addPicture(file, twoTexels(Rgb(1, 0, 0), Rgb(0, 1, 0)));
    Json pbr{{"baseColorTexture", texture}};
    pbr.update(material);
    file.append("materials", {{"pbrMetallicRoughness", pbr}, {"doubleSided", true}});
    file.mesh({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uv}}},
               {"indices", indices},
               {"material", 0}});
    file.root({{"mesh", 0}});
    return file;
}

Rgb colorAt(const TriangleMesh& mesh, double x, double y) {
    const Scene scene(mesh);
    const Hit hit = look(scene, x, y);
    return albedoAt(mesh, hit.triangle, hit.u, hit.v, Rgb(0.5f));
}

TEST(Gltf, EveryComponentTypeOfIndicesAndPositions) {
    const auto withIndices = [](int indices, GltfBuilder& file) {
        file.mesh({{"attributes", {{"POSITION", 0}}}, {"indices", indices}});
        file.root({{"mesh", 0}});
        EXPECT_NEAR(area(loadGlb(file)), 1, 1e-6);
    };
    GltfBuilder bytes, shorts, words;
    for (GltfBuilder* file : {&bytes, &shorts, &words}) file->vectors(kSquare);
    withIndices(bytes.accessor(std::vector<std::uint8_t>{0, 1, 2, 0, 2, 3}, "SCALAR", 1), bytes);
    withIndices(shorts.accessor(kSquareIndices, "SCALAR", 1), shorts);
    withIndices(words.accessor(std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}, "SCALAR", 1), words);

    GltfBuilder plain;
    plain.mesh(
        {{"attributes",
          {{"POSITION", plain.vectors({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0})}}}});
    plain.root({{"mesh", 0}});
    EXPECT_NEAR(area(loadGlb(plain)), 1, 1e-6);

    // KHR_mesh_quantization: whole numbers, normalized and scaled back by the node.
    GltfBuilder quantized;
    quantized.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    std::string corners;
    for (const auto& [x, y] : {std::pair{-127, -127}, {127, -127}, {127, 127}, {-127, 127}})
        corners += std::string{static_cast<char>(x), static_cast<char>(y), 0, 0};
    const int view = quantized.view(corners, 4);
    const int positions = quantized.append("accessors", {{"bufferView", view},
                                                         {"componentType", 5120},
                                                         {"normalized", true},
                                                         {"count", 4},
                                                         {"type", "VEC3"}});
    quantized.mesh({{"attributes", {{"POSITION", positions}}},
                    {"indices", quantized.accessor(kSquareIndices, "SCALAR", 1)}});
    quantized.root({{"mesh", 0}, {"scale", {3, 3, 3}}});
    EXPECT_NEAR(area(loadGlb(quantized)), 36, 1e-5);
}

TEST(Gltf, SparseAccessors) {
    GltfBuilder file;
    const int positions = file.append(
        "accessors",
        {{"componentType", 5126},
         {"count", 4},
         {"type", "VEC3"},
         {"sparse",
          {{"count", 3},
           {"indices",
            {{"bufferView", file.view(std::string("\1\2\3", 3))}, {"componentType", 5121}}},
           {"values",
            {{"bufferView",
              file.view(bytesOf(std::array<float, 9>{1, 0, 0, 1, 1, 0, 0, 1, 0}))}}}}}});
    file.mesh({{"attributes", {{"POSITION", positions}}},
               {"indices", file.accessor(kSquareIndices, "SCALAR", 1)}});
    file.root({{"mesh", 0}});
    EXPECT_NEAR(area(loadGlb(file)), 1, 1e-6);
    file.json["accessors"][0]["count"] = 3;
    const TemporaryFolder folder;
    const auto path = folder.write("a.glb", file.glb());
    expectError([&] { loadMesh({&path, 1}, {}); }, "a.glb", "sparse index 3, expected 0 to 2");
}

TEST(Gltf, StripsAndFansKeepTheirWinding) {
    for (const int mode : {5, 6}) {
        GltfBuilder file;
        const std::vector<float> strip{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0};
        const std::vector<float> fan{0, 0, 0, 1, 0, 0, 1, 1, 0, 0.5, 1.5, 0, 0, 1, 0};
        file.mesh({{"attributes", {{"POSITION", file.vectors(mode == 5 ? strip : fan)}}},
                   {"mode", mode}});
        file.root({{"mesh", 0}});
        const TriangleMesh mesh = loadGlb(file);
        const Scene scene(mesh);
        ASSERT_EQ(mesh.triangles.size(), 3u);
        for (std::uint32_t i = 0; i < 3; ++i) EXPECT_GT(scene.normal(i).z, 0.99f) << mode;
        EXPECT_EQ(mesh.report.mixedWinding, 0u);
    }
}

/// Through nodes with parents, and whether the mesh is flattened or shared, both sides stay where
/// they are.
TEST(Gltf, MirroringNodesKeepTheSides) {
    for (const bool shared : {false, true}) {
        GltfBuilder file = squareGltf();
        file.append("materials", Json::object());
        file.json["meshes"][0]["primitives"][0]["material"] = 0;
        const int child = file.append("nodes", {{"mesh", 0}, {"scale", {-1, 2, 0.5}}});
        file.root({{"children", {child}}, {"translation", {5, 0, 0}}});
        if (shared) file.root({{"mesh", 0}, {"translation", {10, 0, 0}}});
        const TriangleMesh mesh = loadGlb(file);
        ASSERT_EQ(mesh.instances.size(), shared ? 2u : 0u);
        const Scene scene(mesh);
        const Hit hit = look(scene, 4.5, 1.5);
        ASSERT_TRUE(hit.found);
        EXPECT_GT(hit.normal.z, 0.99f);
        EXPECT_NEAR(static_cast<double>(hit.position.x) + mesh.origin.x, 4.5, 1e-5);
        // One-sided: from behind the camera looks through, a shadow is cast all the same.
        EXPECT_FALSE(look(scene, 4.5, 1.5, 1).found);
        EXPECT_FALSE(open(scene, 4.5, 1.5, 1));
        EXPECT_FALSE(open(scene, 4.5, 1.5));
        EXPECT_TRUE(open(scene, 5.5, 1.5));
    }
}

TEST(Gltf, InstancesShareTheirTriangles) {
    GltfBuilder file = squareGltf();
    for (int i = 0; i < 50; ++i)
        file.root({{"mesh", 0}, {"translation", {2 * i, 0, 0}}, {"scale", {1, 1 + i % 2, 1}}});
    // A map without inverse cannot be an instance; it is flattened.
    file.root({{"mesh", 0}, {"translation", {-2, 0, 0}}, {"scale", {1, 1, 0}}});
    const TriangleMesh mesh = loadGlb(file);
    EXPECT_EQ(mesh.triangles.size(), 4u);
    EXPECT_EQ(mesh.instances.size(), 50u);
    EXPECT_EQ(placedCount(mesh), 102u);
    EXPECT_NEAR(area(mesh), 1 + 25 + 50, 1e-4);
    const Scene scene(mesh);
    for (int i = -1; i < 50; ++i) {
        const Hit hit = look(scene, 2 * i + 0.25, 0.5);
        ASSERT_TRUE(hit.found) << i;
        const auto [a, b, c] = placedCorners(mesh, hit.triangle);
        const Vec3d p =
            a + (b - a) * static_cast<double>(hit.u) + (c - a) * static_cast<double>(hit.v);
        EXPECT_NEAR(p.x + mesh.origin.x, 2 * i + 0.25, 1e-4);
        EXPECT_FALSE(look(scene, 2 * i + 1.5, 0.5).found);
    }
}

/// The bake's streams, whose rays start at one place in octets: Embree's coherent ones never came
/// back from instances.
TEST(Gltf, StreamsOfRaysMeetInstances) {
    GltfBuilder file = squareGltf();
    std::mt19937 random(5);
    const auto number = [&] { return static_cast<double>(random()) * 0x1p-31 - 1; };
    for (int i = 0; i < 80; ++i)
        file.root({{"mesh", 0},
                   {"translation", {3 * number(), 3 * number(), 3 * number()}},
                   {"rotation", {number(), number(), number(), number()}},
                   {"scale", {i % 3 == 0 ? -1 : 1, 1, 0.8}}});
    const TriangleMesh mesh = loadGlb(file);
    ASSERT_EQ(mesh.instances.size(), 80u);
    const Scene scene(mesh);
    for (int round = 0; round < 50; ++round) {
        RayStream stream{};
        std::array<RayPacket, RayStream::kSize / RayPacket::kSize> packets{};
        for (std::size_t i = 0; i < RayStream::kSize; ++i) {
            if (i % 8 == 0)
                for (int k = 0; k < 3; ++k) stream.origin[k][i] = static_cast<float>(4 * number());
            for (int k = 0; k < 3; ++k) {
                stream.origin[k][i] = stream.origin[k][i - i % 8];
                stream.direction[k][i] = static_cast<float>(number());
            }
            stream.reach[i] = std::numeric_limits<float>::infinity();
            packets[i / 8].set(
                static_cast<int>(i % 8),
                {stream.origin[0][i], stream.origin[1][i], stream.origin[2][i]},
                {stream.direction[0][i], stream.direction[1][i], stream.direction[2][i]});
        }
        scene.trace(stream, RayStream::kSize);
        for (std::size_t p = 0; p < packets.size(); ++p) {
            const std::uint32_t open = scene.visibility(packets[p], RayPacket::kSize);
            for (std::size_t i = 0; i < 8; ++i)
                EXPECT_EQ(open >> i & 1u, stream.reach[8 * p + i] >= 0 ? 1u : 0u) << p << ' ' << i;
        }
    }
}

TEST(Gltf, BaseColourIsFactorTimesTextureTimesVertexColour) {
    GltfBuilder file = texturedSquare({{"index", 0}}, {{"baseColorFactor", {0.5, 0.25, 1, 1}}});
    EXPECT_EQ(colorAt(loadGlb(file), 0.25, 0.5), Rgb(0.5f, 0, 0));
    EXPECT_EQ(colorAt(loadGlb(file), 0.75, 0.5), Rgb(0, 0.25f, 0));
    const int colors = file.accessor(
        std::vector<float>{.5, .5, .5, .5, .5, .5, .5, .5, .5, .5, .5, .5}, "VEC3", 3);
    file.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = colors;
    EXPECT_EQ(colorAt(loadGlb(file), 0.25, 0.5), Rgb(0.25f, 0, 0));
}

/// The example of the extension's text: the lower left quadrant, turned clockwise by 90 degrees.
TEST(Gltf, TextureTransform) {
    const GltfBuilder file = texturedSquare(
        {{"index", 0},
         {"extensions",
          {{"KHR_texture_transform",
            {{"offset", {0, 1}}, {"rotation", 1.57079632679}, {"scale", {0.5, 0.5}}}}}}},
        Json::object());
    const TriangleMesh mesh = loadGlb(file);
    for (const Vec3f& at : mesh.texcoords) {
        EXPECT_GE(at.x, -1e-6f);
        EXPECT_LE(at.x, 0.5f + 1e-6f);
        EXPECT_GE(at.y, 0.5f - 1e-6f);
        EXPECT_LE(at.y, 1 + 1e-6f);
    }
    EXPECT_NEAR(mesh.texcoords[1].x, 0, 1e-6);
    EXPECT_NEAR(mesh.texcoords[1].y, 0.5, 1e-6);
}

/// Opacity by vertex: the left half of the square is a hole.
TEST(Gltf, CutOutsLetLightThrough) {
    for (const bool shared : {false, true}) {
        GltfBuilder file = squareGltf();
        const int colors = file.accessor(
            std::vector<float>{1, 1, 1, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0}, "VEC4", 4);
        file.append("materials", {{"alphaMode", "MASK"}, {"doubleSided", true}});
        file.json["meshes"][0]["primitives"][0]["material"] = 0;
        file.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = colors;
        file.root({{"mesh", 0}});
        if (shared) file.root({{"mesh", 0}, {"translation", {0, 5, 0}}});
        const TriangleMesh mesh = loadGlb(file);
        const Scene scene(mesh);
        EXPECT_TRUE(open(scene, 0.3, 0.5));
        EXPECT_FALSE(open(scene, 0.7, 0.5));
        EXPECT_FALSE(look(scene, 0.3, 0.5).found);
        EXPECT_TRUE(look(scene, 0.7, 0.5).found);
        file.json["materials"][0]["alphaCutoff"] = 0.8;
        EXPECT_NE(fingerprint(loadGlb(file)), fingerprint(mesh));
        file.json["materials"][0]["alphaMode"] = "BLEND";
        const TriangleMesh blended = loadGlb(file);
        EXPECT_EQ(blended.report.blended, 1u);
        EXPECT_NE(fingerprint(blended), fingerprint(mesh));
    }
}

TEST(Gltf, TextWithABufferBeside) {
    const TemporaryFolder folder;
    GltfBuilder file = squareGltf();
    file.root({{"mesh", 0}});
    folder.write("my buffer.bin", file.data());
    const auto path = folder.write("a.gltf", file.gltf("my%20buffer.bin"));
    EXPECT_NEAR(area(loadMesh({&path, 1}, {})), 1, 1e-6);
    std::filesystem::remove(folder.path() / "my buffer.bin");
    expectError([&] { loadMesh({&path, 1}, {}); }, "a.gltf", "is not a complete glTF 2.0 file");
}

TEST(Gltf, RefusesWhatItCannotDo) {
    const TemporaryFolder folder;
    const auto refuses = [&](const std::function<void(Json&)>& change, const std::string& cause) {
        GltfBuilder file = squareGltf();
        file.root({{"mesh", 0}});
        change(file.json);
        const auto path = folder.write("a.glb", file.glb());
        expectError([&] { loadMesh({&path, 1}, {}); }, "a.glb", cause);
    };
    refuses([](Json& j) { j["extensionsRequired"] = {"KHR_texture_basisu"}; },
            "requires the extension KHR_texture_basisu");
    refuses([](Json& j) { j["asset"]["version"] = "1.0"; }, "version 1.0, expected 2.0");
    refuses([](Json& j) { j["nodes"][0]["mesh"] = 7; }, "mesh 7, expected 0 to 0");
    refuses([](Json& j) { j["accessors"][0]["count"] = 5; }, "do not fit");
    refuses([](Json& j) { j["accessors"][0]["byteOffset"] = 1 << 20; }, "do not fit");
    refuses([](Json& j) { j["bufferViews"][0]["byteLength"] = 1 << 20; },
            "expected them within it");
    refuses([](Json& j) { j["accessors"][0]["componentType"] = 5124; }, "component type 5124");
    // Signed and floating numbers may be negative.
    for (const int type : {5120, 5122, 5126})
        refuses(
            [&](Json& j) {
                Json& indices =
                    j["accessors"][j["meshes"][0]["primitives"][0]["indices"].get<int>()];
                indices["componentType"] = type;
                indices["count"] = 3;
            },
            fmt::format("indices: type {}, expected 5121, 5123 or 5125", type));
    refuses([](Json& j) { j["nodes"][0]["children"] = {0}; }, "has a parent");
    refuses([](Json& j) { j["nodes"][0]["skin"] = 0; }, "skin 0, but the file has none");
    std::string deep(5000, '[');
    const auto path = folder.write("a.gltf", "{\"extras\": " + deep);
    expectError([&] { loadMesh({&path, 1}, {}); }, "a.gltf", "nested deeper");
}

TEST(Gltf, AnimationOfNodesAndTheirParents) {
    GltfBuilder file = squareGltf();
    const int child = file.append("nodes", {{"mesh", 0}, {"translation", {1, 0, 0}}});
    const int parent = file.root({{"children", {child}}});
    const int stepping = file.root({{"mesh", 0}});
    const int still = file.root({{"mesh", 0}});
    const float h = std::sqrt(0.5f);
    file.animate(parent, "rotation", "LINEAR", {0, 2}, {0, 0, 0, 1, 0, 0, h, h});
    file.animate(stepping, "translation", "STEP", {1, 2}, {1, 0, 0, 3, 0, 0});
    file.animate(child, "translation", "CUBICSPLINE", {0, 2},
                 {0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 5, 0, 0, 0, 0, 0});
    file.animate(still, "scale", "LINEAR", {0, 1}, {2, 2, 2, 2, 2, 2});
    const TemporaryFolder folder;
    const GltfDocument document = readGltfDocument(folder.write("a.glb", file.glb()));
    const GltfNodes nodes(document);
    EXPECT_TRUE(nodes.moves(child));
    EXPECT_FALSE(nodes.moves(still));
    EXPECT_NEAR(nodes.duration(), 2, 0);
    EXPECT_NEAR((nodes.at(stepping, 1.99).position - Vec3d(1, 0, 0)).length(), 0, 0);
    EXPECT_NEAR((nodes.at(stepping, 9).position - Vec3d(3, 0, 0)).length(), 0, 0);
    // Half way: 45 degrees about z, and the spline without slopes in its middle.
    const double r = 3 * std::sqrt(0.5);
    EXPECT_NEAR((nodes.at(child, 1).position - Vec3d(r, r, 0)).length(), 0, 1e-6);
    const auto path = folder.path() / "a.glb";
    EXPECT_NEAR(area(loadMesh({&path, 1}, {})), 4, 1e-6);
}

/// There is no set without anything that stands still: the reason is told.
TEST(Gltf, WhereEverythingMovesTheReasonIsTold) {
    GltfBuilder file = squareGltf();
    file.animate(file.root({{"mesh", 0}}), "translation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0});
    expectError([&] { loadGlb(file); }, "a.glb", "everything moves: all nodes with a mesh, 1,");
    file.root({{"mesh", 0}});
    EXPECT_EQ(loadGlb(file).triangles.size(), 2u);
}

}  // namespace
}  // namespace shadowcache::test
