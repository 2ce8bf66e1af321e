// Requests of `--serve` are read with the command line's standards, or refused with key and
// value; the file of pixels counts on, never becomes shorter, and replaces no other file.

#include <gtest/gtest.h>

#include <cstring>

#include "common/base/file_bytes.h"
#include "render/serve/pixel_file.h"
#include "render/serve/requests.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

template <class T>
T commandOf(const std::string& fields) {
    const Request request = parseRequest("{\"id\": 7, " + fields + "}");
    EXPECT_EQ(request.error, "");
    EXPECT_EQ(request.number, 7u);
    if (!request.command || !std::holds_alternative<T>(*request.command)) {
        ADD_FAILURE() << fields;
        return {};
    }
    return std::get<T>(*request.command);
}

std::string errorOf(const std::string& line) {
    const Request request = parseRequest(line);
    EXPECT_FALSE(request.command) << line;
    return request.error;
}

TEST(ServeRequests, LoadHasTheStandardsOfTheCommandLine) {
    const auto load = commandOf<LoadRequest>(R"("request": "load", "set": ["a.glb", "b.ply"])");
    EXPECT_EQ(load.stage.set.files, (std::vector<std::filesystem::path>{"a.glb", "b.ply"}));
    EXPECT_TRUE(load.stage.cache.empty());
    EXPECT_TRUE(load.stage.set.mesh.shadingNormals && load.stage.set.mesh.gloss);
    EXPECT_FALSE(load.stage.set.mesh.zUp || load.stage.set.frame || load.stage.staleOk);
    EXPECT_EQ(load.stage.set.mesh.references, References::inside);
    const auto all = commandOf<LoadRequest>(
        R"("request": "load", "set": ["a"], "cache": "c", "stale-ok": true, "up": "z",
           "scale": 0.01, "set-frame": 48, "fps": 24, "allow-external": true,
           "normals": "geometric", "surfaces": "diffuse", "dynamic": ["d.glb@t.json"])");
    EXPECT_TRUE(all.stage.set.mesh.zUp && all.stage.staleOk);
    EXPECT_FALSE(all.stage.set.mesh.shadingNormals || all.stage.set.mesh.gloss);
    EXPECT_EQ(meshOptionsOf(all.stage.set).stillAt, 2.0);
    EXPECT_EQ(all.stage.set.mesh.references, References::anywhere);
    ASSERT_EQ(all.stage.set.dynamic.size(), 1u);
    EXPECT_EQ(all.stage.set.dynamic[0].track, "t.json");
}

TEST(ServeRequests, LampsHaveGains) {
    const auto lamps =
        commandOf<LampsRequest>(R"("request": "lamps", "lamp": ["*=0", "desk=2,1,0.5"])");
    ASSERT_EQ(lamps.gains.size(), 2u);
    EXPECT_EQ(lamps.gains[1].pattern, "desk");
    EXPECT_EQ(lamps.gains[1].gain, Rgb(2, 1, 0.5f));
    EXPECT_TRUE(commandOf<LampsRequest>(R"("request": "lamps", "lamp": [])").gains.empty());
    for (const char* fields : {R"("lamp": ["desk"])", R"("lamp": ["desk=-1"])", R"("lamp": 1)",
                               R"("gain": 1)", R"("lamp": [], "set": ["a"])"})
        EXPECT_NE(errorOf(std::string(R"({"id": 1, "request": "lamps", )") + fields + "}"), "")
            << fields;
}

TEST(ServeRequests, EnvironmentsTurnAndGain) {
    const auto map = commandOf<EnvironmentRequest>(
        R"("request": "environment", "map": "m.exr", "rotate": -12.5, "gain": 2)");
    EXPECT_EQ(map.light.environment, "m.exr");
    EXPECT_EQ(map.light.rotation.numbers, std::vector{-12.5});
    EXPECT_EQ(map.light.gain, Vec3d(2.0));
    const auto plain = commandOf<EnvironmentRequest>(
        R"("request": "environment", "radiance": [1, 0.1, 1e-3], "gain": [1, 2, 3])");
    EXPECT_EQ(parseRadiance(plain.light.environment), Rgb(1, 0.1f, 1e-3f));
    EXPECT_EQ(plain.light.gain, Vec3d(1, 2, 3));
    const auto mirrored = commandOf<EnvironmentRequest>(
        R"("request": "environment", "map": "m", "rotate": [-1, 0, 0, 0, 1, 0, 0, 0, 1])");
    EXPECT_EQ(mirrored.light.rotation.turn().axis[0], Vec3d(-1, 0, 0));
}

TEST(ServeRequests, CamerasAreStatedOrNamed) {
    const auto stated = commandOf<CameraRequest>(
        R"("request": "camera", "view": {"origin": [1, 2, 3], "forward": [0, 0, -9],
           "up": [0, 1, 1], "height": 4, "shift": [0.25, -0.5], "near": 0.1})");
    const auto& camera = std::get<Camera>(stated.camera);
    EXPECT_EQ(camera.origin, Vec3d(1, 2, 3));
    EXPECT_EQ(camera.height, 4);
    EXPECT_EQ(camera.shiftX, 0.25);
    EXPECT_EQ(camera.shiftY, -0.5);
    EXPECT_EQ(camera.near, 0.1);
    const auto named = commandOf<CameraRequest>(R"("request": "camera", "name": "shot")");
    EXPECT_EQ(std::get<CameraOptions>(named.camera).name, "shot");
}

TEST(ServeRequests, OptionsAreThoseOfTheCommandLine) {
    const auto none = commandOf<OptionsRequest>(R"("request": "options")");
    EXPECT_FALSE(none.picture.rays.spp || none.picture.bounces || none.picture.estimator);
    EXPECT_EQ(none.picture.options.seed, 1u);
    const auto all = commandOf<OptionsRequest>(
        R"("request": "options", "camera-rays": 4, "samples": 2, "bounces": "unlimited",
           "aov": ["normal"], "filter": "box", "clamp-indirect": 3, "seed": 9007199254740991,
           "albedo": 0.25, "material": {"metallic": 1}, "sequence": "random", "budget": "uniform",
           "estimator": "mis")");
    EXPECT_EQ(all.picture.rays.cameraRays, 4);
    EXPECT_EQ(all.picture.bounces, kUnlimitedBounces);
    EXPECT_EQ(all.picture.options.filter, FilterKind::box);
    EXPECT_EQ(all.picture.options.seed, 9007199254740991u);
    EXPECT_EQ(all.picture.options.plain.albedo, Rgb(0.25f));
    EXPECT_EQ(all.picture.options.plain.gloss->metallic, 1);
    EXPECT_EQ(all.picture.sequence, Sequence::kRandom);
    EXPECT_FALSE(all.picture.estimators.cache.adaptive);
}

TEST(ServeRequests, RefusalsNameTheKeyTheValueAndTheWantedOne) {
    const std::pair<const char*, const char*> cases[] = {
        {"", "no JSON at byte"},
        {"{\"id\":1,", "no JSON at byte"},
        {"[1]", "request is [1], expected an object"},
        {"{}", "request: has no id"},
        {R"({"id":-1,"request":"stop"})", "id is -1, expected a whole number from 0"},
        {R"({"id":18446744073709551615,"request":"stop"})", "id is 18446744073709551615"},
        {R"({"id":1.5,"request":"stop"})", "id is 1.5"},
        {R"({"id":1,"request":"stopp"})", "unknown request stopp, did you mean stop?"},
        {R"({"id":1,"request":"stop","now":1})", "stop: unknown key now"},
        {R"({"id":1,"request":"load","set":[1]})", "set is [1], expected a list of texts"},
        {R"({"id":1,"request":"load","set":["a\u0000b"]})", "expected a list of texts"},
        {R"({"id":1,"request":"load","set":["a"],"scale":0})",
         "load: scale 0: expected a number above 0"},
        {R"({"id":1,"request":"load","set":["a"],"up":"x"})", "load: up x: expected one of y, z"},
        {R"({"id":1,"request":"size","width":1e3,"height":3})", "expected a whole number"},
        {R"({"id":1,"request":"size","width":99999999999,"height":3})", "width is 99999999999"},
        {R"({"id":1,"request":"options","target-error":0.01,"spp":4})",
         "options: spp cannot be combined with target-error"},
        {R"({"id":1,"request":"options","albedo":2})", "options: albedo 2: expected 0 to 1"},
        {R"({"id":1,"request":"options","material":{"rough":1}})",
         "options: material rough=1: expected roughness=, metallic=, ior= or specular="},
        {R"({"id":1,"request":"options","spp":1e999})", "number out of range"},
        {R"({"id":1,"request":"camera"})", "expected name, eye with look-at, or view"},
        {R"({"id":1,"request":"camera","view":{"fov":1}})",
         "camera: view: has the unknown key fov"},
        {R"({"id":1,"request":"environment","map":"1,1,1"})", "map is \"1,1,1\", expected a file"}};
    for (const auto& [line, cause] : cases)
        EXPECT_NE(errorOf(line).find(cause), std::string::npos) << line << ": " << errorOf(line);
    EXPECT_NE(errorOf(std::string(1000, '[')).find("nested deeper"), std::string::npos);
}

TEST(PixelFile, CountsOnAndNeverBecomesShorter) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "pixels";
    PixelHeader header;
    header.width = 2;
    header.height = 1;
    EXPECT_EQ(PixelFile(path).write(header, std::vector<Channel>{{"R", {1, 2}}, {"G", {3, 4}}}),
              2u);
    EXPECT_EQ(PixelFile(path).write(header, std::vector<Channel>{{"R", {5, 6}}}), 4u);
    const std::string bytes = readFileBytes(path);
    ASSERT_EQ(bytes.size(), sizeof header + 4 * sizeof(float));
    std::memcpy(&header, bytes.data(), sizeof header);
    EXPECT_EQ(std::memcmp(header.name, "SHCPIXEL", 8), 0);
    EXPECT_EQ(header.sequence, 4u);
    EXPECT_EQ(header.planes, 1u);
    float values[2] = {};
    std::memcpy(values, bytes.data() + sizeof header, sizeof values);
    EXPECT_EQ(values[1], 6);
}

TEST(PixelFile, RefusesWhatIsNotItsOwn) {
    const TemporaryFolder folder;
    const auto other = folder.write("notes.txt", "SHCPIXE");
    expectError([&] { const PixelFile file(other); }, other.string(), "no file of pixels");
    const auto link = folder.path() / "link";
    std::filesystem::create_symlink(folder.path() / "target", link);
    expectError([&] { const PixelFile file(link); }, link.string(), "cannot be written");
    expectError([&] { const PixelFile file(folder.path()); }, folder.path().string(),
                "cannot be written");
}

}  // namespace
}  // namespace shadowcache::test
