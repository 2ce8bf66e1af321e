// Compressed glTF: KHR_draco_mesh_compression, EXT_meshopt_compression, EXT_texture_webp. What the
// libraries' own encoders make is read; what is damaged is refused.

#include <gtest/gtest.h>

#include "common/import/load_mesh.h"
#include "common/mesh/looks.h"
#include "tests/support/compressed_gltf.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

using Json = nlohmann::json;

TriangleMesh loadShaded(const std::string& name, const std::string& bytes) {
    const TemporaryFolder folder;
    const auto path = folder.write(name, bytes);
    return loadMesh({&path, 1}, {.shadingNormals = true});
}

void expectSquare(const TriangleMesh& mesh) {
    ASSERT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(mesh.report.badVertexFaces, 0u);
    Box3d box;
    for (const Vec3f& p : mesh.positions) box.extendBy(Vec3d(p) + mesh.origin);
    EXPECT_NEAR((box.min - Vec3d(0, 0, 0)).length(), 0, 1e-3);
    EXPECT_NEAR((box.max - Vec3d(1, 1, 0)).length(), 0, 1e-3);
}

TEST(GltfCompression, DracoIsRead) {
    for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
        SCOPED_TRACE(method);
        expectSquare(loadShaded("a.glb", dracoFile(dracoSquare(method)).glb()));
    }
    const TemporaryFolder folder;
    const GltfBuilder file = dracoFile(dracoSquare(draco::MESH_EDGEBREAKER_ENCODING));
    folder.write("a.bin", file.data());
    const auto path = folder.write("a.gltf", file.gltf("a.bin"));
    expectSquare(loadMesh({&path, 1}, {}));
}

TEST(GltfCompression, DamagedDracoIsRefused) {
    const auto refuse = [](const GltfBuilder& file, const std::string& cause) {
        expectError([&] { loadShaded("a.glb", file.glb()); }, "a.glb", cause);
    };
    const std::string stream = dracoSquare(draco::MESH_EDGEBREAKER_ENCODING);
    refuse(dracoFile("no stream at all"),
           "mesh 0, primitive 0: KHR_draco_mesh_compression: the bytes do not begin with DRACO");
    refuse(dracoFile(stream, 5), "POSITION: 4 in the stream, expected 5");
    GltfBuilder other = dracoFile(stream);
    other.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]
              ["attributes"]["POSITION"] = 7;
    refuse(other, "no attribute 7 in the stream");
    other = dracoFile(stream);
    other.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]
              ["bufferView"] = 9;
    refuse(other, "buffer view 9");
    other = dracoFile(stream);
    other.json["meshes"][0]["primitives"][0].erase("indices");
    refuse(other, "no indices");
    // Cut anywhere: refused, and if by luck not, a mesh of the same numbers.
    for (std::size_t size = 0; size < stream.size(); ++size) {
        SCOPED_TRACE(size);
        try {
            loadShaded("a.glb", dracoFile(stream.substr(0, size) + std::string(4, '\0')).glb());
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find("a.glb"), std::string::npos) << e.what();
        }
    }
}

/// Counts that a few bytes cannot hold are not allocated.
TEST(GltfCompression, DracoOfHugeCountsIsRefused) {
    std::string stream = dracoSquare(draco::MESH_SEQUENTIAL_ENCODING);
    constexpr std::size_t kCounts = 11;
    stream.replace(kCounts, 2, std::string("\xff\xff\xff\xff\x7f\xff\xff\xff\xff\x7f"));
    const auto refuse = [&](const std::string& cause) {
        expectError([&] { loadShaded("a.glb", dracoFile(stream).glb()); }, "a.glb", cause);
    };
    refuse("34359738367 triangles or points");
    constexpr std::size_t kMinorVersion = 6, kFlags = 10;
    stream[kFlags] = '\x80';
    refuse("metadata in the stream");
    stream[kMinorVersion] = 1;
    refuse("version 2.1, expected 2.2");
}

/// A grid of many triangles: its accessors have no bytes, but the stream has some.
TEST(GltfCompression, DracoMayHoldManyTriangles) {
    constexpr std::uint32_t kSide = 440;  // 2 * 439 * 439 triangles
    draco::Mesh grid;
    grid.set_num_points(kSide * kSide);
    draco::GeometryAttribute positions;
    positions.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 12, 0);
    const int id = grid.AddAttribute(positions, true, kSide * kSide);
    for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
        const std::array<float, 3> at{static_cast<float>(i % kSide), static_cast<float>(i / kSide),
                                      0};
        grid.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), at.data());
    }
    const auto face = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        grid.AddFace({draco::PointIndex(a), draco::PointIndex(b), draco::PointIndex(c)});
    };
    for (std::uint32_t y = 0; y + 1 < kSide; ++y)
        for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
            const std::uint32_t i = y * kSide + x;
            face(i, i + 1, i + kSide + 1);
            face(i, i + kSide + 1, i + kSide);
        }
    draco::Encoder encoder;
    encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);
    draco::EncoderBuffer buffer;
    ASSERT_TRUE(encoder.EncodeMeshToBuffer(grid, &buffer).ok());
    GltfBuilder file = dracoFile({buffer.data(), buffer.size()}, kSide * kSide);
    file.json["accessors"][1]["count"] = 3 * grid.num_faces();
    EXPECT_GT(grid.num_faces(), 349525u);
    EXPECT_EQ(loadShaded("a.glb", file.glb()).triangles.size(), grid.num_faces());
}

/// All attributes that a set has, quantized as exporters do.
TEST(GltfCompression, DracoHoldsNormalsPlacesAndColours) {
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(2);
    using Attribute = draco::GeometryAttribute;
    const int positions = builder.AddAttribute(Attribute::POSITION, 3, draco::DT_FLOAT32);
    const int normals = builder.AddAttribute(Attribute::NORMAL, 3, draco::DT_FLOAT32);
    const int places = builder.AddAttribute(Attribute::TEX_COORD, 2, draco::DT_FLOAT32);
    const int colors = builder.AddAttribute(Attribute::COLOR, 4, draco::DT_UINT8);
    const std::array<float, 3> tilted{0.6f, 0, 0.8f};
    const std::array<std::uint8_t, 4> red{255, 51, 0, 255};
    for (unsigned face = 0; face < 2; ++face) {
        const auto corner = [&](std::size_t k) {
            return &kSquare[3 * std::size_t{kSquareIndices[3 * face + k]}];
        };
        const draco::FaceIndex f(face);
        builder.SetAttributeValuesForFace(positions, f, corner(0), corner(1), corner(2));
        builder.SetAttributeValuesForFace(normals, f, tilted.data(), tilted.data(), tilted.data());
        builder.SetAttributeValuesForFace(places, f, corner(0), corner(1), corner(2));
        builder.SetAttributeValuesForFace(colors, f, red.data(), red.data(), red.data());
    }
    const auto square = builder.Finalize();
    draco::Encoder encoder;
    encoder.SetAttributeQuantization(Attribute::POSITION, 14);
    encoder.SetAttributeQuantization(Attribute::NORMAL, 10);
    encoder.SetAttributeQuantization(Attribute::TEX_COORD, 12);
    draco::EncoderBuffer buffer;
    ASSERT_TRUE(encoder.EncodeMeshToBuffer(*square, &buffer).ok());
    GltfBuilder file = dracoFile({buffer.data(), buffer.size()});
    Json& primitive = file.json["meshes"][0]["primitives"][0];
    const auto add = [&](const char* name, int id, int type, const char* kind, bool normalized) {
        primitive["attributes"][name] = file.append(
            "accessors",
            {{"componentType", type}, {"count", 4}, {"type", kind}, {"normalized", normalized}});
        primitive["extensions"]["KHR_draco_mesh_compression"]["attributes"][name] = id;
    };
    const auto idOf = [&](int attribute) {
        return static_cast<int>(square->attribute(attribute)->unique_id());
    };
    add("NORMAL", idOf(normals), 5126, "VEC3", false);
    add("TEXCOORD_0", idOf(places), 5126, "VEC2", false);
    add("COLOR_0", idOf(colors), 5121, "VEC4", true);
    const TriangleMesh mesh = loadShaded("a.glb", file.glb());
    expectSquare(mesh);
    ASSERT_EQ(mesh.normals.size(), 4u);
    for (const Vec3f& n : mesh.normals) EXPECT_NEAR(n.x, 0.6f, 0.01f);
    ASSERT_EQ(mesh.colors.size(), 4u);
    for (const Rgb& color : mesh.colors) EXPECT_EQ(color, Rgb(1.0f, 0.2f, 0.0f));
}

/// They announce compressed data and hold plain numbers.
TEST(GltfCompression, CasesWithoutStreamsAreRefused) {
    const auto refuse = [](const char* name, const std::string& cause) {
        const auto path = std::filesystem::path(SHADOWCACHE_CASES) / name;
        expectError([&] { loadMesh({&path, 1}, {}); }, name, cause);
    };
    refuse("draco_without_stream.gltf",
           "mesh 0, primitive 0: KHR_draco_mesh_compression: the bytes do not begin with DRACO");
    refuse("meshopt_without_stream.gltf",
           "buffer view 0: EXT_meshopt_compression: damaged, or no data of mode ATTRIBUTES");
}

TriangleMesh loadMeshopt(const Json& json, const std::string& data) {
    const TemporaryFolder folder;
    folder.write("a.bin", data);
    const auto path = folder.write("a.gltf", json.dump());
    return loadMesh({&path, 1}, {.shadingNormals = true});
}

TEST(GltfCompression, MeshoptIsRead) {
    std::string data;
    const Json json = meshoptFile(meshoptPositions(), meshoptTriangles(), data);
    expectSquare(loadMeshopt(json, data));
}

/// Positions through the exponential filter, normals through the octahedral one.
TEST(GltfCompression, MeshoptFiltersAreUndone) {
    const auto encode = [](const void* values, std::size_t stride) {
        std::string bytes(meshopt_encodeVertexBufferBound(4, stride), '\0');
        bytes.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(bytes.data()),
                                                bytes.size(), values, 4, stride));
        return bytes;
    };
    std::array<std::uint32_t, 12> positions{};
    meshopt_encodeFilterExp(positions.data(), 4, 12, 15, kSquare.data());
    const std::vector<float> tilted{.6f, 0, .8f, 0, .6f, 0, .8f, 0, .6f, 0, .8f, 0, .6f, 0, .8f, 0};
    std::array<std::int8_t, 16> normals{};
    meshopt_encodeFilterOct(normals.data(), 4, 4, 8, tilted.data());
    std::string data;
    Json json = meshoptFile(encode(positions.data(), 12), meshoptTriangles(), data);
    json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["filter"] = "EXPONENTIAL";
    const std::string stream = encode(normals.data(), 4);
    Json view = meshoptView({{"byteOffset", data.size()}, {"byteLength", stream.size()}},
                            "ATTRIBUTES", 4, 4);
    view["extensions"]["EXT_meshopt_compression"]["filter"] = "OCTAHEDRAL";
    json["bufferViews"].push_back(view);
    json["accessors"].push_back({{"bufferView", 2},
                                 {"componentType", 5120},
                                 {"normalized", true},
                                 {"count", 4},
                                 {"type", "VEC3"}});
    json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 2;
    json["buffers"][0]["byteLength"] = data.size() + stream.size();
    const TriangleMesh mesh = loadMeshopt(json, data + stream);
    expectSquare(mesh);
    ASSERT_EQ(mesh.normals.size(), 4u);
    for (const Vec3f& n : mesh.normals) EXPECT_NEAR(n.x, 0.6f, 0.02f);
}

TEST(GltfCompression, DamagedMeshoptIsRefused) {
    std::string data;
    const Json whole = meshoptFile(meshoptPositions(), meshoptTriangles(), data);
    const auto refuse = [&](const char* key, const Json& value, const std::string& cause) {
        SCOPED_TRACE(key);
        Json json = whole;
        json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"][key] = value;
        expectError([&] { loadMeshopt(json, data); }, "a.gltf", cause);
    };
    refuse("mode", "FOO", "buffer view 0: EXT_meshopt_compression: mode 'FOO'");
    refuse("filter", "FOO", "filter 'FOO'");
    refuse("filter", "QUATERNION", "byteStride 12 with filter QUATERNION");
    refuse("byteStride", 13, "byteStride 13");
    refuse("byteStride", 260, "byteStride 260");
    refuse("count", 400, "damaged");
    refuse("count", 1000000, "1000000 elements in");
    refuse("count", -1, "count -1, expected a whole number");
    refuse("byteLength", 100000, "100000 bytes at 0 of a buffer");
    refuse("buffer", 7, "buffer 7");
    for (std::size_t size = 1; size < meshoptPositions().size(); ++size) {
        const Json json = meshoptFile(meshoptPositions().substr(0, size), meshoptTriangles(), data);
        expectError([&] { loadMeshopt(json, data); }, "a.gltf", "damaged");
    }
    // Raw numbers where compressed ones are announced.
    const Json raw = meshoptFile(std::string(48, '\0'), meshoptTriangles(), data);
    expectError([&] { loadMeshopt(raw, data); }, "a.gltf", "no data of mode ATTRIBUTES");
}

TEST(GltfCompression, WebpIsRead) {
    const std::string webp = webpPicture();
    const auto fileOf = [](const std::string& picture) {
        GltfBuilder file;
        const int positions = file.vectors(kSquare);
        const int uv = file.accessor(std::vector<float>{0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
        const int image =
            file.append("images", {{"bufferView", file.view(picture)}, {"mimeType", "image/webp"}});
        file.append("textures", {{"extensions", {{"EXT_texture_webp", {{"source", image}}}}}});
        file.append("materials",
                    {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
        file.mesh({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uv}}},
                   {"indices", file.accessor(kSquareIndices, "SCALAR", 1)},
                   {"material", 0}});
        file.root({{"mesh", 0}});
        file.json["extensionsRequired"] = {"EXT_texture_webp"};
        return file.glb();
    };
    const TriangleMesh mesh = loadShaded("a.glb", fileOf(webp));
    EXPECT_EQ(albedoAt(mesh, 0, 0.25f, 0, Rgb(0.5f)), Rgb(1, 0, 0));
    EXPECT_EQ(albedoAt(mesh, 0, 0.75f, 0, Rgb(0.5f)), Rgb(0, 1, 0));
    for (std::size_t cut = 4; cut + 13 < webp.size(); ++cut)
        EXPECT_NE(describe(loadShaded("a.glb", fileOf(webp.substr(0, webp.size() - cut))).report)
                      .find("1 texture whose picture"),
                  std::string::npos);
    EXPECT_EQ(describe(mesh.report).find("whose picture"), std::string::npos);
}

}  // namespace
}  // namespace shadowcache::test
