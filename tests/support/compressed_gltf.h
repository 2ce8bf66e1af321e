#pragma once

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>
#include <webp/encode.h>

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/gltf_builder.h"

namespace shadowcache::test {

/// The square as a Draco stream; its positions are attribute 0.
inline std::string dracoSquare(int method) {
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
    if (!encoder.EncodeMeshToBuffer(*mesh, &buffer).ok()) return {};
    return {buffer.data(), buffer.size()};
}

/// Accessors of it have no bytes of their own.
inline GltfBuilder dracoFile(const std::string& stream, std::size_t points = 4) {
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

inline std::string meshoptPositions() {
    std::string bytes(meshopt_encodeVertexBufferBound(4, 12), '\0');
    bytes.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(bytes.data()),
                                            bytes.size(), kSquare.data(), 4, 12));
    return bytes;
}

inline std::string meshoptTriangles() {
    const std::vector<unsigned> indices(kSquareIndices.begin(), kSquareIndices.end());
    std::string bytes(meshopt_encodeIndexBufferBound(6, 4), '\0');
    bytes.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(bytes.data()),
                                           bytes.size(), indices.data(), 6));
    return bytes;
}

inline nlohmann::json meshoptView(const nlohmann::json& raw, const char* mode, std::size_t count,
                                  std::size_t stride) {
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
inline nlohmann::json meshoptFile(const std::string& positions, const std::string& triangles,
                                  std::string& data) {
    GltfBuilder file;
    const int p = file.view(positions), t = file.view(triangles);
    const nlohmann::json views = file.json["bufferViews"];
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
    nlohmann::json json = file.json;
    json["buffers"] = {
        {{"byteLength", data.size()}, {"uri", "a.bin"}},
        {{"byteLength", 60}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
    return json;
}

/// A red and a green texel, without loss, or as they are after it.
inline std::string webpPicture(bool lossless = true) {
    const std::vector<std::uint8_t> texels{255, 0, 0, 255, 0, 255, 0, 255};
    std::uint8_t* encoded = nullptr;
    const std::size_t size = lossless ? WebPEncodeLosslessRGBA(texels.data(), 2, 1, 8, &encoded)
                                      : WebPEncodeRGBA(texels.data(), 2, 1, 8, 75, &encoded);
    std::string bytes(reinterpret_cast<const char*>(encoded), size);
    WebPFree(encoded);
    return bytes;
}

}  // namespace shadowcache::test
