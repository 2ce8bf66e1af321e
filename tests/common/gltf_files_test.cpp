// glTF files as other programs write them: URIs, chunks, and what is not whole.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <limits>

#include "common/import/load_mesh.h"
#include "common/import/mesh_reader.h"
#include "common/import/set_files.h"
#include "common/shot/camera_source.h"
#include "common/shot/gltf_shot.h"
#include "common/shot/picture_view.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/loaded_mesh.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

using Json = nlohmann::json;

std::string said(const GltfBuilder& file) {
    return describe(loadBytes("a.glb", file.glb()).report);
}

std::string base64(const std::string& bytes) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        unsigned bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits =
                bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            text += i + k <= bytes.size() ? kDigits[bits >> (18 - 6 * k) & 63u] : '=';
    }
    return text;
}

TEST(GltfUris, DataAreOfAnyMediaType) {
    const GltfBuilder file = squareScene();
    for (const char* type :
         {"application/octet-stream", "application/gltf-buffer", "", "text/plain",
          "application/binary", "application/octet-stream;charset=utf-8"})
        EXPECT_EQ(loadBytes("a.gltf", file.gltf("data:" + std::string(type) + ";base64," +
                                                base64(file.data())))
                      .triangles.size(),
                  2u)
            << type;
    EXPECT_EQ(
        loadBytes("a.gltf", file.gltf("DATA:;BASE64," + base64(file.data()))).triangles.size(), 2u);
    for (const char* uri : {"data:application/octet-stream,abc", "data:", "data:;base64"})
        expectError([&] { loadBytes("a.gltf", file.gltf(uri)); }, "a.gltf",
                    "a data URI that is not in base64, expected data:TYPE;base64,...");
}

TEST(GltfUris, OfFilesMayBeEscapedAndTheirBuffersShorter) {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "sub dir");
    const GltfBuilder file = squareScene();
    folder.write("sub dir/my buffer.bin", file.data() + "and more");
    for (const char* uri :
         {"sub%20dir/my%20buffer.bin", "sub dir/my buffer.bin", "./sub%20dir//my%20buffer.bin"}) {
        const auto path = folder.write("a.gltf", file.gltf(uri));
        EXPECT_EQ(loadMesh({&path, 1}, {}).triangles.size(), 2u) << uri;
        EXPECT_EQ(filesOf(path, References::inside).size(), 2u) << uri;
    }
    folder.write("sub dir/my buffer.bin", file.data().substr(1));
    const auto path = folder.write("a.gltf", file.gltf("sub%20dir/my%20buffer.bin"));
    expectError([&] { loadMesh({&path, 1}, {}); }, "a.gltf", "is not a complete glTF 2.0 file");
}

TEST(GltfUris, APlusIsAPlus) {
    const TemporaryFolder folder;
    const GltfBuilder file = squareScene();
    folder.write("a+b.bin", file.data());
    folder.write("a b.bin", std::string(file.data().size(), '\0'));
    for (const char* uri : {"a+b.bin", "a%2Bb.bin", "a%2bb.bin"}) {
        const auto path = folder.write("a.gltf", file.gltf(uri));
        EXPECT_EQ(loadMesh({&path, 1}, {}).triangles.size(), 2u) << uri;
    }
}

/// A camera that nobody asks for costs nothing; one without a name has a number.
TEST(GltfCameras, AreFoundByNameOrNumber) {
    GltfBuilder file = squareScene();
    const auto add = [&](const Json& camera, const Json& node) {
        Json placed = node;
        placed["camera"] = file.append("cameras", camera);
        file.root(placed);
    };
    const auto perspective = [](const Json& yfov) {
        return Json{{"type", "perspective"}, {"perspective", {{"yfov", yfov}, {"znear", 0.1}}}};
    };
    add(perspective(0), {{"name", "closed"}});
    add({{"type", "orthographic"}, {"orthographic", {{"ymag", -1}}}}, {{"name", "mirrored"}});
    add(perspective("wide"), {{"name", "worded"}});
    add(perspective(0.5), Json::object());
    add(perspective(0.75), {{"name", "eye"}});
    const TemporaryFolder folder;
    const auto path = folder.write("a.glb", file.glb());
    EXPECT_EQ(loadMesh({&path, 1}, {}).triangles.size(), 2u);
    const std::vector<GltfShot> shots = openShots({&path, 1}, {}, 24);
    const auto view = [&](const std::string& name) {
        const NamedCamera found = findCamera(shots, name);
        return found.shot->camera(found.node, 1).fovY;
    };
    EXPECT_EQ(view("3"), 0.5);
    EXPECT_EQ(view("4"), 0.75);
    EXPECT_EQ(view("eye"), 0.75);
    expectError([&] { view("closed"); }, "a.glb", "yfov 0, expected radians in (0, pi)");
    expectError([&] { view("mirrored"); }, "a.glb", "ymag -1, expected a number above 0");
    expectError([&] { view("worded"); }, "a.glb", "yfov \"wide\", expected a number");
    expectError([&] { view("5"); }, "--camera 5", "closed, mirrored, worded, 3, eye");
    const std::string list = describe(shots[0]);
    EXPECT_NE(list.find("camera 3: perspective"), std::string::npos) << list;
    EXPECT_NE(list.find("camera closed: cannot be used"), std::string::npos) << list;
}

/// The camera of a file with one of this view, `scale` metres a unit.
Camera cameraOf(const char* type, const Json& view, double scale = 1) {
    GltfBuilder file = squareScene();
    file.root(
        {{"name", "eye"}, {"camera", file.append("cameras", {{"type", type}, {type, view}})}});
    const TemporaryFolder folder;
    const auto path = folder.write("a.glb", file.glb());
    MeshOptions options;
    options.scale = scale;
    const std::vector<GltfShot> shots = openShots({&path, 1}, options, 24);
    return CameraSource({"eye", {}, {}}, shots).at(1);
}

TEST(GltfCameras, HaveClipPlanes) {
    const Camera perspective =
        cameraOf("perspective", {{"yfov", 0.5}, {"znear", 0.25}, {"zfar", 40}}, 2);
    EXPECT_EQ(perspective.near, 0.5);
    EXPECT_EQ(perspective.far, 80);
    const Camera open = cameraOf("perspective", {{"yfov", 0.5}, {"znear", 0.1}});
    EXPECT_EQ(open.near, 0.1);
    EXPECT_EQ(open.far, std::numeric_limits<double>::infinity());
    const Camera flat =
        cameraOf("orthographic", {{"xmag", 3}, {"ymag", 2}, {"znear", 0}, {"zfar", 7}});
    EXPECT_EQ(flat.near, 0);
    EXPECT_EQ(flat.far, 7);
    for (const auto& planes : {std::pair(2.0, 1.0), {1.0, 1.0}, {-1.0, 1.0}})
        expectError(
            [&] {
                cameraOf("perspective",
                         {{"yfov", 0.5}, {"znear", planes.first}, {"zfar", planes.second}});
            },
            "a.glb",
            fmt::format("znear {:g} and zfar {:g}, expected 0 <= znear < zfar", planes.first,
                        planes.second));
    expectError(
        [] {
            cameraOf("perspective", {{"yfov", 0.5}, {"znear", 2e30}});
        },
        "a.glb", "znear 2e+30 m away");
}

TEST(GltfCameras, TellPicturesOfAnotherAspect) {
    const Camera wide = cameraOf("perspective", {{"yfov", 0.5}, {"aspectRatio", 16.0 / 9}});
    const Camera flat = cameraOf("orthographic", {{"xmag", 3.2}, {"ymag", 1.8}});
    for (const Camera& camera : {wide, flat}) {
        for (const auto& [width, height] : {std::pair(1920, 1080), {160, 90}, {10, 6}, {11, 6}})
            EXPECT_EQ(aspectNote(camera, width, height), "");
        EXPECT_EQ(aspectNote(camera, 800, 600),
                  "made for pictures 1.778 times as wide as high, the size of 800x600 has 1.333: "
                  "the view is as high as the camera's, and narrower");
        EXPECT_NE(aspectNote(camera, 200, 90).find("and wider"), std::string::npos);
    }
    EXPECT_EQ(aspectNote(cameraOf("perspective", {{"yfov", 0.5}}), 800, 600), "");
    expectError(
        [] {
            cameraOf("orthographic", {{"xmag", -3}, {"ymag", 2}});
        },
        "a.glb", "xmag -3, expected a number above 0");
}

TEST(GlbChunks, OfOtherKindsArePassedOver) {
    const auto resized = [](std::string bytes) {
        return bytes.replace(8, 4, bytesOf(static_cast<std::uint32_t>(bytes.size())));
    };
    const std::string more = bytesOf(std::uint32_t{4}) + "XTRAabcd";
    const std::string good = squareScene().glb();
    EXPECT_EQ(loadBytes("a.glb", resized(good + more)).triangles.size(), 2u);
    EXPECT_EQ(loadBytes("a.glb", good + "bytes behind").triangles.size(), 2u);
    EXPECT_EQ(loadBytes("a.gltf", good).triangles.size(), 2u);
    std::string filled = good;
    if (const std::size_t at = filled.find("} "); at != filled.npos) filled[at + 1] = '\0';
    EXPECT_EQ(loadBytes("a.glb", filled).triangles.size(), 2u);
    expectError([&] { loadBytes("a.glb", good.substr(0, good.size() - 4)); }, "a.glb",
                "is not a complete glTF 2.0 file");
}

TEST(GltfVersions, ThatAreNeededAndNewerAreRefused) {
    GltfBuilder file = squareScene();
    file.json["asset"] = {{"version", "2.1"}, {"minVersion", "2.0"}};
    EXPECT_EQ(said(file), "2 triangles");
    file.json["asset"]["minVersion"] = "2.1";
    expectError([&] { said(file); }, "a.glb", "needs glTF 2.1, expected 2.0");
}

TEST(GltfPrimitives, WhatIsNotWholeIsNamed) {
    GltfBuilder file;
    file.mesh({{"attributes", {{"POSITION", file.vectors(kSquare)}}},
               {"indices", file.accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 2}, "SCALAR", 1)}});
    file.root({{"mesh", 0}});
    EXPECT_NE(said(file).find("1 primitive whose last corners make no triangle and are left out"),
              std::string::npos)
        << said(file);
    GltfBuilder empty = squareScene();
    const int none =
        empty.append("accessors", {{"componentType", 5126}, {"count", 0}, {"type", "VEC3"}});
    empty.json["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", none}}}});
    empty.json["meshes"][0]["primitives"].push_back({{"attributes", {{"NORMAL", 0}}}});
    EXPECT_EQ(said(empty), "2 triangles; 2 primitives whose positions are missing (left out)");
    GltfBuilder bare = squareScene();
    bare.append("materials", {{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 7, 1, 1}}}}});
    bare.json["meshes"][0]["primitives"][0]["material"] = 0;
    EXPECT_EQ(said(bare), std::string("2 triangles; 1 ") + kClampedMaterials);
}

TEST(GltfShapes, OfAnotherKindAreRefused) {
    const auto refused = [](const char* list, const Json& object, const std::string& cause) {
        GltfBuilder file = squareScene();
        const int index = file.append(list, object);
        if (list == std::string("samplers")) {
            file.append("textures", {{"sampler", index}});
            file.append("materials", {{"normalTexture", {{"index", 0}}}});
        }
        if (file.json.contains("materials")) {
            EXPECT_NO_THROW(said(file));  // what nothing uses is not read
            file.json["meshes"][0]["primitives"][0]["material"] = 0;
        }
        expectError(
            [&] { said(file); }, "a.glb",
            fmt::format("{} {}{}", std::string(list).substr(0, std::string(list).size() - 1), index,
                        cause));
    };
    refused("nodes", {{"translation", {0, 1}}},
            ": translation [0,1], expected a list of 3 numbers");
    refused("nodes", {{"rotation", {0, 0, 0, "1"}}}, ": rotation [0,0,0,\"1\"], expected a list");
    refused("nodes", {{"scale", "2"}}, ": scale \"2\", expected a list of 3 numbers");
    refused("nodes", {{"matrix", {1, 0, 0, 0}}}, ": matrix [1,0,0,0], expected a list of 16");
    refused("nodes", {{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2}}},
            ": matrix [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,2], expected 0, 0, 0, 1 in the last row");
    refused("materials", {{"alphaMode", "blend"}},
            ": alphaMode \"blend\", expected one of OPAQUE, MASK, BLEND");
    refused("materials", {{"doubleSided", "true"}},
            ": doubleSided \"true\", expected true or false");
    refused("materials", {{"alphaCutoff", nullptr}}, ": alphaCutoff null, expected a number");
    refused("materials", {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0}}}}},
            ": pbrMetallicRoughness: baseColorFactor [1,0,0], expected a list of 4 numbers");
    refused("materials", {{"pbrMetallicRoughness", {{"metallicFactor", {0}}}}},
            ": pbrMetallicRoughness: metallicFactor [0], expected a number");
    refused("samplers", {{"wrapS", 99}}, ": wrapS 99, expected 33071, 33648 or 10497");
    refused("animations",
            {{"samplers", {{{"interpolation", "FOO"}}}},
             {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "scale"}}}}}}},
            ", sampler 0: interpolation \"FOO\", expected one of LINEAR, STEP, CUBICSPLINE");
    refused("animations",
            {{"samplers", Json::array()}, {"channels", {{{"target", {{"path", "size"}}}}}}},
            ", channel 0: target: path \"size\", expected one of translation");
}

}  // namespace
}  // namespace shadowcache::test
