// Compressed glTF: KHR_draco_mesh_compression, EXT_meshopt_compression, EXT_texture_webp. What the
// libraries' own encoders make is read; what is damaged is refused.

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>
#include <webp/encode.h>

#include "common/import/load_mesh.h"
#include "common/mesh/looks.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

using Json = nlohmann::json;

TriangleMesh loadBytes(const std::string& name, const std::string& bytes) {
    const TemporaryFolder folder;
    const auto path = folder.write(name, bytes);
    return loadMesh({&path, 1}, {});
}

void expectSquare(const TriangleMesh& mesh) {
    ASSERT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(mesh.report.badVertexFaces, 0u);
    Box3d box;
    for (const Vec3f& p : mesh.positions) box.extendBy(Vec3d(p) + mesh.origin);
    EXPECT_NEAR((box.min - Vec3d(0, 0, 0)).length(), 0, 1e-3);
    EXPECT_NEAR((box.max - Vec3d(1, 1, 0)).length(), 0, 1e-3);
}

/// The square as a Draco stream; its positions are attribute 0.
std::string dracoSquare(int method) {
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(2);
    const int positions =
        builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    for (int face = 0; face < 2; ++face) {
        const auto corner = [&](std::size_t k) {
            return &kSquare[3 *
                            std::size_t{kSquareIndices[3 * static_cast<std::size_t>(face) + k]}];
        };
        builder.SetAttributeValuesForFace(positions, draco::FaceIndex(static_cast<unsigned>(face)),
                                          corner(0), corner(1), corner(2));
    }
    const auto mesh = builder.Finalize();
    draco::Encoder encoder;
    encoder.SetEncodingMethod(method);
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
    return {buffer.data(), buffer.size()};
}

/// Accessors of it have no bytes of their own.
GltfBuilder dracoFile(const std::string& stream, std::size_t points = 4) {
    GltfBuilder file;
    const int view = file.view(stream);
    const int positions =
        file.append("accessors", {{"componentType", 5126}, {"count", points}, {"type", "VEC3"}});
    const int indices =
        file.append("accessors", {{"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}});
    file.mesh({{"attributes", {{"POSITION", positions}}},
               {"indices", indices},
               {"extensions",
                {{"KHR_draco_mesh_compression",
                  {{"bufferView", view}, {"attributes", {{"POSITION", 0}}}}}}}});
    file.root({{"mesh", 0}});
    file.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    return file;
}

TEST(GltfCompression, DracoIsRead) {
    for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
        SCOPED_TRACE(method);
        expectSquare(loadBytes("a.glb", dracoFile(dracoSquare(method)).glb()));
    }
    const TemporaryFolder folder;
    const GltfBuilder file = dracoFile(dracoSquare(draco::MESH_EDGEBREAKER_ENCODING));
    folder.write("a.bin", file.data());
    const auto path = folder.write("a.gltf", file.gltf("a.bin"));
    expectSquare(loadMesh({&path, 1}, {}));
}

TEST(GltfCompression, DamagedDracoIsRefused) {
    const auto refuse = [](const GltfBuilder& file, const std::string& cause) {
        expectError([&] { loadBytes("a.glb", file.glb()); }, "a.glb", cause);
    };
    const std::string stream = dracoSquare(draco::MESH_EDGEBREAKER_ENCODING);
    refuse(dracoFile("no stream at all"),
           "mesh 0: KHR_draco_mesh_compression: the bytes do not begin with DRACO");
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
            loadBytes("a.glb", dracoFile(stream.substr(0, size) + std::string(4, '\0')).glb());
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
        expectError([&] { loadBytes("a.glb", dracoFile(stream).glb()); }, "a.glb", cause);
    };
    refuse("34359738367 triangles or points");
    constexpr std::size_t kMinorVersion = 6, kFlags = 10;
    stream[kFlags] = '\x80';
    refuse("metadata in the stream");
    stream[kMinorVersion] = 1;
    refuse("version 2.1, expected 2.2");
}

std::string meshoptPositions() {
    std::string bytes(meshopt_encodeVertexBufferBound(4, 12), '\0');
    bytes.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(bytes.data()),
                                            bytes.size(), kSquare.data(), 4, 12));
    return bytes;
}

std::string meshoptTriangles() {
    const std::vector<unsigned> indices(kSquareIndices.begin(), kSquareIndices.end());
    std::string bytes(meshopt_encodeIndexBufferBound(6, 4), '\0');
    bytes.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(bytes.data()),
                                           bytes.size(), indices.data(), 6));
    return bytes;
}

Json meshoptView(const Json& raw, const char* mode, std::size_t count, std::size_t stride) {
    return {{"buffer", 1},
            {"byteOffset", 0},
            {"byteLength", count * stride},
            {"extensions",
             {{"EXT_meshopt_compression",
               {{"buffer", 0},
                {"byteOffset", raw["byteOffset"]},
                {"byteLength", raw["byteLength"]},
                {"byteStride", stride},
                {"count", count},
                {"mode", mode}}}}}};
}

/// The square, with a buffer that only stands for the decoded bytes, in text.
Json meshoptFile(const std::string& positions, const std::string& triangles, std::string& data) {
    GltfBuilder file;
    const int p = file.view(positions), t = file.view(triangles);
    const Json views = file.json["bufferViews"];
    file.json["bufferViews"] = {
        meshoptView(views[static_cast<std::size_t>(p)], "ATTRIBUTES", 4, 12),
        meshoptView(views[static_cast<std::size_t>(t)], "TRIANGLES", 6, 2)};
    file.append("accessors",
                {{"bufferView", 0}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}});
    file.append("accessors",
                {{"bufferView", 1}, {"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}});
    file.mesh({{"attributes", {{"POSITION", 0}}}, {"indices", 1}});
    file.root({{"mesh", 0}});
    file.json["extensionsRequired"] = {"EXT_meshopt_compression"};
    data = file.data();
    Json json = file.json;
    json["buffers"] = {
        {{"byteLength", data.size()}, {"uri", "a.bin"}},
        {{"byteLength", 60}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
    return json;
}

TriangleMesh loadMeshopt(const Json& json, const std::string& data) {
    const TemporaryFolder folder;
    folder.write("a.bin", data);
    const auto path = folder.write("a.gltf", json.dump());
    return loadMesh({&path, 1}, {});
}

TEST(GltfCompression, MeshoptIsRead) {
    std::string data;
    const Json json = meshoptFile(meshoptPositions(), meshoptTriangles(), data);
    expectSquare(loadMeshopt(json, data));
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
    refuse("count", -1, "no count");
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
    const std::vector<std::uint8_t> texels{255, 0, 0, 255, 0, 255, 0, 255};
    std::uint8_t* encoded = nullptr;
    const std::size_t size = WebPEncodeLosslessRGBA(texels.data(), 2, 1, 8, &encoded);
    const std::string webp(reinterpret_cast<const char*>(encoded), size);
    WebPFree(encoded);
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
    const TriangleMesh mesh = loadBytes("a.glb", fileOf(webp));
    EXPECT_EQ(albedoAt(mesh, 0, 0.25f, 0, Rgb(0.5f)), Rgb(1, 0, 0));
    EXPECT_EQ(albedoAt(mesh, 0, 0.75f, 0, Rgb(0.5f)), Rgb(0, 1, 0));
    for (std::size_t cut = 4; cut + 13 < webp.size(); ++cut)
        expectError([&] { loadBytes("a.glb", fileOf(webp.substr(0, webp.size() - cut))); }, "a.glb",
                    "WebP");
}

}  // namespace
}  // namespace shadowcache::test
