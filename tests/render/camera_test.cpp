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

TEST(Camera, ShiftMovesThePictureAndPixelsStretch) {
    for (const double height : {0.0, 3.0}) {
        Camera camera = lookAt({1, 2, 3}, {1, 2, -5}, {0, 1, 0}, 1.0);
        camera.height = height;
        const CameraRays plain(camera, 1.5);
        Camera moved = camera;
        moved.shiftX = 0.25;
        moved.shiftY = -0.5;
        const CameraRays shifted(moved, 1.5);
        expectNear(shifted.direction({0.4, 0.1}), plain.direction({0.65, 0.6}));
        expectNear(shifted.start({0.4, 0.1}), plain.start({0.65, 0.6}));
        camera.pixelAspect = 2;
        expectNear(CameraRays(camera, 0.75).direction({1, 0}), plain.direction({1, 0}));
        expectNear(CameraRays(camera, 0.75).start({1, 0}), plain.start({1, 0}));
    }
}

TEST(CameraFile, ReadsTheLensOfTheFileAndOfEachFrame) {
    const TemporaryFolder folder;
    const std::string place = R"("origin": [0,0,0], "forward": [0,0,-1], "up": [0,1,0])";
    const CameraTrack track = readCameraFile(folder.write(
        "c.json", R"({"cam": {"height": 3, "shift": [0.1, -2], "pixel_aspect": 1.5, "fps": 24,
                      "frames": [{)" + place + "}, {" + place +
                      R"(, "yfov": 0.5, "shift": [0, 1]}]}})"));
    EXPECT_EQ(track.frames[0].height, 3);
    EXPECT_EQ(track.frames[0].shiftX, 0.1);
    EXPECT_EQ(track.frames[0].shiftY, -2);
    EXPECT_EQ(track.frames[0].pixelAspect, 1.5);
    EXPECT_EQ(track.frames[1].height, 0);
    EXPECT_EQ(track.frames[1].fovY, 0.5);
    EXPECT_EQ(track.frames[1].shiftX, 0);
    EXPECT_EQ(track.frames[1].shiftY, 1);
    EXPECT_EQ(track.frames[1].pixelAspect, 1.5);
}

TEST(CameraFile, NamesTheLensThatIsWrong) {
    const TemporaryFolder folder;
    const auto refuses = [&](const std::string& lens, const std::string& cause) {
        const auto path = folder.write(
            "c.json", R"({"cam": {"fps": 24, )" + lens +
                          R"(, "frames": [{"origin": [0,0,0], "forward": [0,0,1], "up": [0,1,0]}]}})");
        expectError([&] { readCameraFile(path); }, path.string(), cause);
    };
    refuses(R"("height": 0)", "cam.height is 0, expected a height above 0, up to 1e+07");
    refuses(R"("height": 2e7)", "cam.height is 20000000.0");
    refuses(R"("yfov": 1, "height": 2)", "cam.height is 2, expected yfov or height, not both");
    refuses(R"("yfov": 1, "shift": 2)", "cam.shift is 2, expected two numbers up to 100");
    refuses(R"("yfov": 1, "shift": [0, 101])", "cam.shift is [0,101]");
    refuses(R"("yfov": 1, "pixel_aspect": 0)", "cam.pixel_aspect is 0, expected a number between");
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
