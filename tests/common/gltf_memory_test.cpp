// Small glTF files whose parts share data ask for no more memory than files of their size may.

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdlib>
#include <filesystem>
#include <functional>

#include "common/image/png.h"
#include "common/import/load_mesh.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache {
namespace {

using Json = nlohmann::json;
using test::expectError;
using test::GltfBuilder;
using test::squareGltf;
using test::TemporaryFolder;

constexpr int kManyZeros = 1 << 20;
constexpr const char* kSharing = "shares data so often";

/// An accessor of zeros, for which the file holds no bytes.
int zeros(GltfBuilder& file, const char* type) {
    return file.append("accessors",
                       {{"componentType", 5126}, {"count", kManyZeros}, {"type", type}});
}

/// A file of a mesh whose primitives are all alike.
GltfBuilder manyPrimitives(int count, const std::function<Json(GltfBuilder&)>& make) {
    GltfBuilder file;
    const Json primitive = make(file);
    file.append("meshes",
                {{"primitives", Json(Json::array_t(static_cast<std::size_t>(count), primitive))}});
    file.root({{"mesh", 0}});
    return file;
}

class GltfMemory : public testing::Test {
protected:
    void refuse(const GltfBuilder& file, const std::string& cause) const {
        const auto path = folder_.write("a.glb", file.glb());
        expectError([&] { loadMesh({&path, 1}, {}); }, "a.glb", cause);
    }
    void refuse(const GltfBuilder& file) const { refuse(file, kSharing); }

    TemporaryFolder folder_;
};

TEST_F(GltfMemory, PrimitivesOfZerosAreFew) {
    const auto make = [](GltfBuilder& file) {
        return Json{{"attributes", {{"POSITION", zeros(file, "VEC3")}}}};
    };
    const GltfBuilder file = manyPrimitives(8, make);
    EXPECT_LT(file.glb().size(), 1000u);
    refuse(file);
    GltfBuilder more = manyPrimitives(1, make);
    more.json["accessors"][0]["count"] = 2 * kManyZeros;
    refuse(more, "zeros, expected at most");
}

TEST_F(GltfMemory, PrimitivesThatShareCornersAreFew) {
    refuse(manyPrimitives(1000, [](GltfBuilder& file) {
        const std::vector<std::uint8_t> corners(3 * 30000, 0);
        return Json{{"attributes", {{"POSITION", file.vectors(test::kSquare)}}},
                    {"indices", file.accessor(corners, "SCALAR", 1)}};
    }));
}

/// A node that flattens its mesh cannot be an instance: its triangles are copied.
TEST_F(GltfMemory, NodesThatFlattenAMeshAreFew) {
    GltfBuilder file = manyPrimitives(1, [](GltfBuilder& f) {
        return Json{{"attributes", {{"POSITION", f.vectors(std::vector<float>(9 * 10000, 0))}}}};
    });
    for (int i = 0; i < 500; ++i) file.root({{"mesh", 0}, {"scale", {1, 0, 1}}});
    refuse(file);
}

TEST_F(GltfMemory, AnimationsThatShareKeysAreFew) {
    GltfBuilder file = squareGltf();
    const int node = file.root({{"mesh", 0}});
    file.animate(node, "translation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0});
    Json& animation = file.json["animations"][0];
    animation["samplers"][0]["input"] = zeros(file, "SCALAR");
    animation["samplers"][0]["output"] = zeros(file, "VEC3");
    const Json channel = animation["channels"][0];
    for (int i = 0; i < 10; ++i) animation["channels"].push_back(channel);
    refuse(file);
}

TEST_F(GltfMemory, MorphTargetsOfZerosAreFew) {
    const auto make = [](int targets) {
        return manyPrimitives(1, [&](GltfBuilder& f) {
            const int vectors = zeros(f, "VEC3");
            const Json target{{"POSITION", vectors}};
            return Json{
                {"attributes", {{"POSITION", vectors}}},
                {"targets", Json(Json::array_t(static_cast<std::size_t>(targets), target))}};
        });
    };
    GltfBuilder file = make(20);
    file.json["nodes"][0]["weights"] = Json(Json::array_t(20, 1.0));
    refuse(file);
    // Control: of weight 0 they ask for nothing.
    file.json["nodes"][0]["weights"] = Json(Json::array_t(20, 0.0));
    refuse(file, "no triangle left");
}

TEST_F(GltfMemory, InstancesOfZerosAreFew) {
    GltfBuilder file = squareGltf();
    const Json attributes{{"TRANSLATION", zeros(file, "VEC3")}};
    file.root(
        {{"mesh", 0}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}}});
    refuse(file);
}

TEST_F(GltfMemory, SkinsThatShareJointsAreFew) {
    GltfBuilder file = squareGltf();
    const int joint = file.root(Json::object());
    file.append("skins", {{"joints", Json(Json::array_t(10000, joint))}});
    for (int i = 0; i < 100; ++i) file.root({{"mesh", 0}, {"skin", 0}});
    refuse(file);
}

TEST_F(GltfMemory, TexturesThatShareAPictureAreFew) {
    GltfBuilder file = squareGltf();
    file.root({{"mesh", 0}});
    const std::string png = encodePng({1024, 1024, std::vector<Rgb>(1024 * 1024, Rgb(0.5f))}, 0);
    const int image =
        file.append("images", {{"bufferView", file.view(png)}, {"mimeType", "image/png"}});
    Json& mesh = file.json["meshes"][0];
    const Json primitive = mesh["primitives"][0];
    mesh["primitives"] = Json::array();
    for (int i = 0; i < 20; ++i) {
        const int texture = file.append("textures", {{"source", image}});
        Json one = primitive;
        one["material"] = file.append(
            "materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}});
        mesh["primitives"].push_back(one);
    }
    refuse(file);
}

/// Control: as exporters share, with corners of each primitive's own.
TEST_F(GltfMemory, ManyPrimitivesOfOneListOfVerticesAreRead) {
    GltfBuilder file;
    std::vector<float> positions;
    for (int i = 0; i < 3000; ++i)
        for (const float x : test::kSquare) positions.push_back(x + static_cast<float>(i));
    const int shared = file.vectors(positions);
    Json primitives = Json::array();
    for (std::uint16_t i = 0; i < 100; ++i) {
        std::vector<std::uint16_t> corners;
        corners.reserve(std::size(test::kSquareIndices));
        for (const std::uint16_t k : test::kSquareIndices)
            corners.push_back(static_cast<std::uint16_t>(k + 4 * i));
        primitives.push_back({{"attributes", {{"POSITION", shared}}},
                              {"indices", file.accessor(corners, "SCALAR", 1)}});
    }
    file.append("meshes", {{"primitives", primitives}});
    file.root({{"mesh", 0}});
    const auto path = folder_.write("a.glb", file.glb());
    EXPECT_EQ(loadMesh({&path, 1}, {}).triangles.size(), 200u);
}

/// Ends the program with 0 if a file of a kilobyte that shares what it can is loaded in less than a
/// gigabyte.
[[noreturn]] void loadAKilobyte() {
    {
        const GltfBuilder file = manyPrimitives(1, [](GltfBuilder& f) {
            const int vectors = zeros(f, "VEC3");
            return Json{
                {"attributes", {{"POSITION", vectors}, {"NORMAL", vectors}, {"COLOR_0", vectors}}}};
        });
        const TemporaryFolder folder;
        const auto path = folder.write("a.glb", file.glb());
        if (std::filesystem::file_size(path) >= 1000) std::exit(2);
        try {
            loadMesh({&path, 1}, {});
        } catch (const Error&) {  // a set without area
        }
    }
    rusage use{};
    getrusage(RUSAGE_SELF, &use);
    std::exit(use.ru_maxrss < 1 << 20 ? 0 : 1);  // [kB]
}

/// What is let through at a kilobyte stays far below two gigabytes. In a process of its own, so
/// that no other test's memory counts.
TEST(GltfMemoryDeathTest, OfAKilobyteIsBelowAGigabyte) {
    testing::FLAGS_gtest_death_test_style = "threadsafe";
    EXPECT_EXIT(loadAKilobyte(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace shadowcache
