// Every number in the JSON files that are read, and every float of a glTF file's buffer, replaced
// by numbers at the ends of all types: what comes through is finite, and rays meet it.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/image/png.h"
#include "common/import/load_mesh.h"
#include "common/math/limits.h"
#include "common/shot/camera_file.h"
#include "common/shot/camera_source.h"
#include "common/shot/moving_set.h"
#include "common/shot/view.h"
#include "tests/support/extreme_numbers.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/loaded_mesh.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

using Json = nlohmann::json;

/// The texts that come of replacing one number of a JSON text by an extreme one, for each of both.
void forEachChange(const Json& good, const std::function<void(const std::string&)>& use) {
    const Json flat = good.flatten();
    for (const auto& [key, value] : flat.items()) {
        if (!value.is_number()) continue;
        Json marked = good;
        marked[Json::json_pointer(key)] = "@number@";
        const std::string text = marked.dump();
        const std::size_t at = text.find("\"@number@\"");
        for (const std::string& number : extremeNumbers()) {
            if (number == "inf" || number == "-inf" || number == "nan") continue;
            SCOPED_TRACE(key + " = " + number);
            use(std::string(text).replace(at, 10, number));
        }
    }
}

/// Whether `read` accepts its file; if not, it must say so in an Error of one line.
bool isRead(const std::function<void()>& read) {
    try {
        read();
        return true;
    } catch (const Error& e) {
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
        return false;
    }
}

/// Rays through the corners and the middle of a camera's film, as the renderer traces them.
void expectTraceable(const Camera& camera, const Scene& scene) {
    const CameraRays film(camera, 1.5);
    RayPacket rays{};
    int count = 0;
    for (const double x : {0.0, 0.5, 1.0})
        for (const double y : {0.0, 1.0}) {
            const CameraRay ray = film.through({x, y});
            const Vec3f origin = startIn(scene, ray);
            const Vec3f direction(ray.direction);
            ASSERT_TRUE(isInReach(Vec3d(origin) / 10)) << origin;
            ASSERT_NEAR(static_cast<double>(direction.length()), 1, 1e-5);
            scene.intersect(origin, direction);
            rays.originX[count] = origin.x;
            rays.originY[count] = origin.y;
            rays.originZ[count] = origin.z;
            rays.directionX[count] = direction.x;
            rays.directionY[count] = direction.y;
            rays.directionZ[count++] = direction.z;
        }
    Hit hits[RayPacket::kSize];
    scene.intersect(rays, count, hits);
    scene.visibility(rays, count);
}

TEST(FileNumbers, CameraFiles) {
    const TemporaryFolder folder;
    const auto mesh = loadFile(folder.write("set.obj", squareObj()));
    const Scene scene(mesh);
    const Json good = Json::parse(
        R"({"cam": {"yfov": 0.9, "fps": 12.0, "frames": [{"origin": [0.5, 0.5, 2.0],
            "forward": [0.0, -0.5, -1.0], "up": [0.0, 1.0, 0.0]}]}})");
    int read = 0, refused = 0;
    forEachChange(good, [&](const std::string& text) {
        const auto path = folder.write("camera.json", text);
        CameraTrack track;
        if (!isRead([&] { track = readCameraFile(path); })) {
            ++refused;
            return;
        }
        ++read;
        expectTraceable(track.frames[0], scene);
    });
    EXPECT_GT(read, 50);
    EXPECT_GT(refused, 50);
}

TEST(FileNumbers, TracksOfMovingFiles) {
    const TemporaryFolder folder;
    const auto mesh = loadFile(folder.write("set.obj", squareObj()));
    const Json good = Json::parse(
        R"({"frames": [{"translation": [1.0, 0.0, 0.0], "rotation": [0.0, 0.0, 0.0, 1.0],
            "scale": [1.0, 2.0, 1.0]}]})");
    const Camera camera = lookAt({0.5, 0.5, 2}, {0.5, 0.5, 0}, {0, 1, 0}, 0.9);
    int read = 0, refused = 0;
    forEachChange(good, [&](const std::string& text) {
        const std::vector<DynamicFile> files{
            {folder.path() / "set.obj", folder.write("track.json", text)}};
        if (!isRead([&] {
                Scene scene(mesh);
                const std::vector<DynamicObject> objects = openDynamic(files, {}, 24);
                MovingSet moving({}, objects, {}, mesh.origin);
                scene.setMoving(moving.pose(1));
                expectTraceable(camera, scene);
            }))
            ++refused;
        else
            ++read;
    });
    EXPECT_GT(read, 50);
    EXPECT_GT(refused, 50);
}

/// A set with two instances, a cut-out texture, both kinds of camera, and an animation.
GltfBuilder richGltf(const TemporaryFolder& folder) {
    writePng(folder.path() / "a.png", {2, 2, std::vector<Rgb>(4, Rgb(0.5f))}, 0);
    GltfBuilder file = squareGltf();
    const int view = file.view(readBytes(folder.path() / "a.png"));
    file.append("images", {{"bufferView", view}, {"mimeType", "image/png"}});
    file.append("textures", {{"source", 0}});
    const Json transform{{"offset", {0.1, 0.2}}, {"scale", {2.0, 2.0}}, {"rotation", 0.3}};
    file.append("materials", {{"alphaMode", "MASK"},
                              {"alphaCutoff", 0.4},
                              {"pbrMetallicRoughness",
                               {{"baseColorFactor", {0.5, 0.6, 0.7, 1.0}},
                                {"baseColorTexture",
                                 {{"index", 0},
                                  {"texCoord", 0},
                                  {"extensions", {{"KHR_texture_transform", transform}}}}}}}});
    auto& primitive = file.json["meshes"][0]["primitives"][0];
    primitive["material"] = 0;
    primitive["attributes"]["TEXCOORD_0"] =
        file.accessor<float>({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
    primitive["attributes"]["NORMAL"] = file.vectors({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
    file.root({{"mesh", 0}, {"rotation", {0.0, 0.0, 0.0, 1.0}}, {"scale", {1.0, 1.0, 1.0}}});
    file.root({{"mesh", 0}, {"translation", {2.0, 0.0, 0.0}}});
    const int moved = file.root({{"mesh", 0}, {"name", "moved"}});
    file.append("cameras",
                {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}});
    file.append("cameras",
                {{"type", "orthographic"},
                 {"orthographic", {{"xmag", 1.0}, {"ymag", 1.0}, {"zfar", 9.0}, {"znear", 0.1}}}});
    file.root({{"camera", 0}, {"name", "one"}, {"translation", {0.5, 0.5, 3.0}}});
    file.root({{"camera", 1},
               {"name", "two"},
               {"matrix",
                {1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.5, 0.5, 3.0, 1.0}}});
    file.animate(moved, "translation", "LINEAR", {0, 1}, {0, 0, 1, 1, 0, 1});
    file.animate(moved, "rotation", "CUBICSPLINE", {0, 1},
                 {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0});
    return file;
}

/// Loads a file as a shot is loaded, and traces rays of its cameras in three frames.
void useAsShot(const std::filesystem::path& path) {
    const TriangleMesh mesh = loadFile(path);
    Scene scene(mesh);
    for (const Vec3f& p : mesh.positions) ASSERT_TRUE(isInReach(Vec3d(p) / 2)) << p;
    const std::vector<std::filesystem::path> files{path};
    const std::vector<GltfShot> shots = openShots(files, {}, 24);
    MovingSet moving(shots, {}, {}, mesh.origin);
    for (const char* name : {"one", "two"}) {
        const CameraSource camera({name, {}, {}}, shots);
        for (const int frame : {1, 12, 30}) {
            scene.setMoving(moving.pose(frame));
            expectTraceable(camera.at(frame), scene);
        }
    }
    describe(shots[0]);
}

TEST(FileNumbers, GltfText) {
    const TemporaryFolder folder;
    const GltfBuilder file = richGltf(folder);
    folder.write("a.bin", file.data());
    useAsShot(folder.write("a.gltf", file.gltf("a.bin")));
    int read = 0, refused = 0;
    forEachChange(Json::parse(file.gltf("a.bin")), [&](const std::string& text) {
        const auto path = folder.write("a.gltf", text);
        ++(isRead([&] { useAsShot(path); }) ? read : refused);
    });
    EXPECT_GT(read, 200);
    EXPECT_GT(refused, 200);
}

TEST(FileNumbers, GltfBuffers) {
    const TemporaryFolder folder;
    const GltfBuilder file = richGltf(folder);
    const auto path = folder.write("a.gltf", file.gltf("a.bin"));
    using Limits = std::numeric_limits<float>;
    int read = 0, refused = 0;
    for (std::size_t at = 0; at + sizeof(float) <= file.data().size(); at += sizeof(float))
        for (const float number :
             {Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN(), Limits::max(),
              -Limits::max(), Limits::denorm_min(), Limits::min(), -0.0f, 1e13f}) {
            std::string bytes = file.data();
            bytes.replace(at, sizeof number, bytesOf(number));
            folder.write("a.bin", bytes);
            SCOPED_TRACE(fmt::format("{} = {}", at, number));
            ++(isRead([&] { useAsShot(path); }) ? read : refused);
        }
    EXPECT_GT(read, 200);
    EXPECT_GT(refused, 20);
}

}  // namespace
}  // namespace shadowcache::test
