#include "common/shot/camera.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

void expectNear(const Vec3d& a, const Vec3d& b) {
    EXPECT_LT((a - b).length(), 1e-12) << a << " and " << b;
}

TEST(Camera, RaysFollowTheFilm) {
    const Camera camera = lookAt({1, 2, 3}, {1, 2, -5}, {0, 1, 0}, kPi / 2);
    expectNear(CameraRays(camera, 2.0).direction({0.5, 0.5}), {0, 0, -1});
    expectNear(CameraRays(camera, 2.0).direction({0.5, 0.0}), Vec3d(0, 1, -1).normalized());
    expectNear(CameraRays(camera, 2.0).direction({1.0, 0.5}), Vec3d(2, 0, -1).normalized());
    expectNear(CameraRays(camera, 1.0).direction({0.0, 1.0}), Vec3d(-1, -1, -1).normalized());
}

TEST(Camera, LookAtMakesUpUpright) {
    const Camera camera = lookAt({0, 5, 0}, {3, 1, 2}, {0, 1e200, 0}, 1.0);
    EXPECT_NEAR(camera.up.dot(camera.forward), 0.0, 1e-15);
    EXPECT_NEAR(camera.up.length(), 1.0, 1e-15);
    EXPECT_GT(camera.up.y, 0.0);
}

TEST(Camera, LookAtRefusesNonsense) {
    const Vec3d eye(0, 0, 0);
    const Vec3d up(0, 1, 0);
    expectError([&] { lookAt(eye, eye, up, 1.0); }, "", "coincide");
    expectError([&] { lookAt(eye, {0, 2, 0}, up, 1.0); }, "", "along its up vector");
    expectError([&] { lookAt(eye, {1, 0, 0}, {0, 0, 0}, 1.0); }, "", "up vector");
    expectError([&] { lookAt(eye, {1, 0, 0}, up, 0.0); }, "", "(0, pi)");
    expectError([&] { lookAt(eye, {1, 0, 0}, up, std::nan("")); }, "", "(0, pi)");
}

std::string cameraJson(const std::string& yfov, const std::string& origin,
                       const std::string& forward, const std::string& up) {
    const std::string frame =
        R"({"t": 0, "origin": )" + origin + R"(, "forward": )" + forward + R"(, "up": )" + up + "}";
    return R"({"cam": {"yfov": )" + yfov + R"(, "fps": 24, "frames": [)" + frame + "," + frame +
           "]}}";
}

const std::string kGood = cameraJson("0.8", "[1,2,3]", "[0,0,-2]", "[0,1,1]");

TEST(CameraFile, ReadsFrames) {
    const TemporaryFolder folder;
    const CameraTrack track = readCameraFile(folder.write("c.json", kGood));
    EXPECT_DOUBLE_EQ(track.fovY, 0.8);
    EXPECT_DOUBLE_EQ(track.fps, 24.0);
    ASSERT_EQ(track.frames.size(), 2u);
    const Camera& camera = cameraAtFrame(track, 2);
    EXPECT_EQ(camera.origin, Vec3d(1, 2, 3));
    expectNear(camera.forward, {0, 0, -1});
    expectNear(camera.up, {0, 1, 0});
    EXPECT_DOUBLE_EQ(camera.fovY, 0.8);
    expectError([&] { cameraAtFrame(track, 300); }, "c.json", "frame 300 of 2, expected 1 to 2");
    expectError([&] { cameraAtFrame(track, 0); }, "c.json", "frame 0 of 2");
}

TEST(CameraFile, NamesTheKeyTheValueAndTheWantedOne) {
    const TemporaryFolder folder;
    const auto refuses = [&](const std::string& text, const std::string& cause) {
        const auto path = folder.write("c.json", text);
        expectError([&] { readCameraFile(path); }, path.string(), cause);
    };
    const std::string up = "[0,1,0]";
    refuses(cameraJson("0", "[0,0,0]", "[0,0,1]", up),
            "cam.yfov is 0, expected radians in (0, pi)");
    refuses(cameraJson("3.2", "[0,0,0]", "[0,0,1]", up), "cam.yfov is 3.2");
    refuses(cameraJson("\"wide\"", "[0,0,0]", "[0,0,1]", up), "cam.yfov is \"wide\"");
    refuses(cameraJson("1", "[0,0]", "[0,0,1]", up),
            "cam.frames[0].origin is [0,0], expected three");
    refuses(cameraJson("1", "[0,0,null]", "[0,0,1]", up), "cam.frames[0].origin is [0,0,null]");
    refuses(cameraJson("1", "[0,0,1e999]", "[0,0,1]", up), "out of range");
    refuses(cameraJson("1", "[0,0,NaN]", "[0,0,1]", up), "no JSON at byte");
    refuses(cameraJson("1", "[0,0,0]", "[0,0,0]", up), "forward is [0,0,0], expected a vector");
    refuses(cameraJson("1", "[0,0,0]", "[0,3,0]", up),
            "up is [0,1,0], expected a vector not along");
    refuses(cameraJson("1", "[0,0,0]", "[0,0,1]", "[0,0,0]"), "up is [0,0,0]");
    refuses(R"({"cam": {"yfov": 1, "fps": 24, "frames": []}})", "cam.frames is []");
    refuses(R"({"cam": {"yfov": 1, "fps": 24}})", "has no cam.frames");
    refuses(R"({"cam": {"yfov": 1, "fps": 24, "frames": [{"origin": [0,0,0]}]}})",
            "has no cam.frames[0].forward");
    refuses(R"({"cam": {"yfov": 1, "fps": 24, "frames": [5]}})", "cam.frames[0] is 5");
    refuses(R"({"cam": {"yfov": 1, "fps": -1, "frames": []}})", "cam.fps is -1");
    refuses(R"({"cam": 3})", "cam is 3, expected an object");
    refuses(R"({"scene": {}})", "has no cam");
    refuses("[1, 2]", "no JSON object");
    refuses(kGood.substr(0, kGood.size() / 2), "truncated");
    refuses("ply\nformat ascii 1.0\n", "no JSON at byte");
    refuses("", "is empty");
    refuses(R"({"version": 2, )" + kGood.substr(1), "version is 2, expected 1");
    expectError([&] { readCameraFile(folder.path()); }, folder.path().string(), "is a directory");
    expectError([&] { readCameraFile(folder.path() / "no.json"); }, "no.json", "no such file");
}

TEST(CameraFile, EveryCutOffFileIsRefused) {
    const TemporaryFolder folder;
    for (std::size_t length = 1; length < kGood.size(); ++length) {
        const auto path = folder.write("c.json", kGood.substr(0, length));
        EXPECT_THROW(readCameraFile(path), Error) << length;
    }
}

}  // namespace
}  // namespace shadowcache::test
