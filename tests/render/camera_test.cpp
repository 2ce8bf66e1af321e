// Rays follow the film, its shift, pixels that are not square, near and far plane; those of a
// lens meet in its focus plane and use it uniformly; a camera between two; camera files are
// read, or refused with key and value.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "common/random/sequence.h"
#include "common/shot/camera_file.h"
#include "common/shot/camera_json.h"
#include "common/shot/camera_rays.h"
#include "common/shot/picture_view.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

void expectNear(const Vec3d& a, const Vec3d& b) {
    EXPECT_LT((a - b).length(), 1e-12) << a << " and " << b;
}

TEST(Camera, RaysFollowTheFilm) {
    const Camera camera = lookAt({1, 2, 3}, {1, 2, -5}, {0, 1, 0}, kPi / 2);
    expectNear(CameraRays(camera, 2.0).through({0.5, 0.5}).direction, {0, 0, -1});
    expectNear(CameraRays(camera, 2.0).through({0.5, 0.0}).direction, Vec3d(0, 1, -1).normalized());
    expectNear(CameraRays(camera, 2.0).through({1.0, 0.5}).direction, Vec3d(2, 0, -1).normalized());
    expectNear(CameraRays(camera, 1.0).through({0.0, 1.0}).direction,
               Vec3d(-1, -1, -1).normalized());
}

/// A place by a matrix of points as rows, over its fourth number.
Vec3d transformed(const Vec3d& place, const PointMatrix& matrix) {
    std::array<double, 4> out{};
    for (std::size_t column = 0; column < 4; ++column)
        for (std::size_t row = 0; row < 4; ++row)
            out[column] += (row < 3 ? place[static_cast<int>(row)] : 1) *
                           static_cast<double>(matrix[4 * row + column]);
    return Vec3d(out[0], out[1], out[2]) / out[3];
}

// The attributes against the rays, whatever the camera; a picture's center in the control.
TEST(Camera, IsWhatThePictureSaysOfIt) {
    for (const double height : {0.0, 3.0})
        for (const double near : {0.0, 0.25}) {
            Camera camera = lookAt({1, 2, 3}, {2, 2.5, -5}, {0.1, 1, 0}, 0.7);
            camera.height = height;
            camera.near = near;
            camera.pixelAspect = 2;
            camera.shiftX = 0.25;
            camera.shiftY = -0.125;
            const ExrView view = viewOf(camera, 32, 36);
            EXPECT_EQ(view.pixelAspect, 2);
            for (const FilmPosition at : {FilmPosition{0.1, 0.9}, FilmPosition{1, 0.25}}) {
                const CameraRay ray = CameraRays(camera, 32.0 / 36).through(at);
                const Vec3d place = ray.start + ray.direction * 7;
                const Vec3d seen = transformed(place, *view.worldToNdc);
                EXPECT_NEAR(seen.x, at.x, 1e-5);
                EXPECT_NEAR(seen.y, at.y, 1e-5);
                const Vec3d inCamera = transformed(place, *view.worldToCamera);
                EXPECT_NEAR(inCamera.z, (place - camera.origin).dot(camera.forward), 1e-5);
                if (height > 0) continue;
                // On the screen window, whose x points to the left.
                const double left = -inCamera.x / inCamera.z, up = inCamera.y / inCamera.z;
                const auto number = [](float f) { return static_cast<double>(f); };
                const double wide = number(view.screenWidth), high = wide * 36 / 32 / 2;
                EXPECT_NEAR(left, number(view.screenCenter[0]) + (0.5 - at.x) * wide, 1e-5);
                EXPECT_NEAR(up, number(view.screenCenter[1]) + (0.5 - at.y) * high, 1e-5);
            }
        }
    const ExrView straight = viewOf(lookAt({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.7), 40, 20);
    EXPECT_FLOAT_EQ(straight.screenWidth, static_cast<float>(4 * std::tan(0.35)));
    EXPECT_EQ(straight.screenCenter[0], 0);
}

// What a ray of the film meets is projected to where the ray went through; what is behind the near
// plane is not.
TEST(Camera, ProjectsPlacesToTheirRays) {
    for (const double height : {0.0, 3.0}) {
        Camera camera = lookAt({1, 2, 3}, {2, 2.5, -5}, {0.1, 1, 0}, 0.7);
        camera.height = height;
        camera.near = 0.25;
        camera.pixelAspect = 2;
        camera.shiftX = 0.25;
        camera.shiftY = -0.125;
        const CameraRays rays(camera, 1.5);
        for (const FilmPosition at : {FilmPosition{0.1, 0.9}, FilmPosition{1.5, -0.25}}) {
            const CameraRay ray = rays.through(at);
            const auto found = rays.project(ray.start + ray.direction * 7);
            ASSERT_TRUE(found);
            EXPECT_NEAR(found->x, at.x, 1e-12);
            EXPECT_NEAR(found->y, at.y, 1e-12);
            EXPECT_FALSE(rays.project(ray.start - ray.direction * 0.01));
        }
    }
}

TEST(Camera, ShiftMovesTheFilmByItsWidthsAndHeights) {
    Camera camera = lookAt({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, kPi / 2);
    const CameraRays straight(camera, 2.0);
    camera.shiftX = 0.25;
    camera.shiftY = -0.5;
    const CameraRays shifted(camera, 2.0);
    for (const FilmPosition at : {FilmPosition{0.5, 0.5}, FilmPosition{0.1, 0.9}})
        expectNear(shifted.through(at).direction,
                   straight.through({at.x + 0.25, at.y + 0.5}).direction);
    camera.height = 3;
    expectNear(CameraRays(camera, 2.0).through({0.5, 0.5}).start, {0.25 * 6, -0.5 * 3, 0});
}

TEST(Camera, WidePixelsSeeMoreToTheSides) {
    Camera camera = lookAt({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, kPi / 2);
    camera.pixelAspect = 1.5;
    expectNear(CameraRays(camera, 2.0).through({1.0, 0.5}).direction, Vec3d(3, 0, -1).normalized());
}

TEST(Camera, RaysGoFromTheNearPlaneToTheFarOne) {
    Camera camera = lookAt({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, kPi / 2);
    EXPECT_EQ(CameraRays(camera, 1.0).through({0, 0}).reach, camera.far);
    camera.near = 2;
    camera.far = 5;
    for (const FilmPosition at : {FilmPosition{0.5, 0.5}, FilmPosition{0, 1}}) {
        const CameraRay ray = CameraRays(camera, 1.0).through(at);
        EXPECT_NEAR(ray.start.z, -2, 1e-12);
        EXPECT_NEAR(ray.skipped, ray.start.length(), 1e-12);
        EXPECT_NEAR((ray.start + ray.direction * ray.reach).z, -5, 1e-12);
    }
}

Camera throughALens(int blades) {
    Camera camera = lookAt({1, 2, 3}, {1, 2, -5}, {0, 1, 0}, 1.0);
    camera.lens = {.radius = 0.25, .focus = 4, .blades = blades, .rotation = 0.3};
    return camera;
}

TEST(Lens, RaysOfAPlaceOnTheFilmMeetInTheFocusPlane) {
    for (const int blades : {0, 5}) {
        Camera camera = throughALens(blades);
        for (const double height : {0.0, 2.0}) {
            camera.height = height;
            const CameraRays rays(camera, 1.5);
            const FilmPosition at{0.2, 0.7};
            const CameraRay middle = rays.through(at);
            const Vec3d sharp = middle.start + middle.direction * (4 / middle.cosine);
            for (const double u : {0.1, 0.6, 0.9}) {
                const CameraRay ray = rays.through(at, {u, 0.8, 0});
                expectNear(ray.start + ray.direction * (4 / ray.cosine), sharp);
                EXPECT_GT((ray.start - middle.start).length(), 0.05);
            }
        }
    }
}

/// Share of the lens's rays that leave it within `radius` of its middle.
///
/// @param power  of the sample's numbers: only with 1 are they uniform
double shareWithin(const Camera& camera, double radius, double power = 1) {
    constexpr std::size_t kRays = 1 << 14;
    std::vector<std::uint32_t> u(kRays), v(kRays);
    owenSobol(0, 0, 7, u);
    owenSobol(0, 1, 7, v);
    const CameraRays rays(camera, 1.0);
    double within = 0;
    for (std::size_t i = 0; i < kRays; ++i) {
        const LensSample sample{std::pow(static_cast<double>(toUnitFloat(u[i])), power),
                                std::pow(static_cast<double>(toUnitFloat(v[i])), power), 0};
        within += (rays.through({0.5, 0.5}, sample).start - camera.origin).length() < radius;
    }
    return within / kRays;
}

TEST(Lens, IsUniformlyUsed) {
    for (const int blades : {0, 3, 6}) {
        const Camera camera = throughALens(blades);
        const double radius = camera.lens.radius;
        // Of the triangle, what its inscribed circle holds.
        const double inner = 0.45 * radius;
        const double area =
            blades == 0 ? std::numbers::pi * radius * radius
                        : blades / 2.0 * radius * radius * std::sin(2 * std::numbers::pi / blades);
        const double wanted = std::numbers::pi * inner * inner / area;
        EXPECT_NEAR(shareWithin(camera, inner), wanted, 0.005) << blades;
        EXPECT_EQ(shareWithin(camera, radius * 1.0001), 1);
        EXPECT_GT(std::abs(shareWithin(camera, inner, 2) - wanted), 0.03) << "control: " << blades;
    }
}

TEST(CameraMove, IsStraightBetweenTwoFrames) {
    Camera a = lookAt({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1.0);
    Camera b = lookAt({2, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.5);
    b.far = 10;
    expectError([&] { between(a, b, 0.5); }, "", "right angle");
    b = lookAt({2, 0, 0}, {3, 0, -2}, {0, 1, 0}, 0.5);
    const Camera middle = between(a, b, 0.5);
    EXPECT_EQ(middle.origin, Vec3d(1, 0, 0));
    EXPECT_NEAR(middle.forward.dot(a.forward), middle.forward.dot(b.forward), 1e-12);
    EXPECT_NEAR(middle.forward.length(), 1, 1e-12);
    EXPECT_EQ(middle.fovY, 0.75);
    EXPECT_EQ(middle.far, a.far);
    const CameraRays rays(CameraMove(a, b), 1.0);
    expectNear(rays.through({0.5, 0.5}).start, middle.origin);
    EXPECT_NEAR(rays.through({0.5, 0.5}, {0.5, 0.5, 0.25}).start.x, 0.5, 1e-12);
    b.height = 1;
    expectError([&] { between(a, b, 0.5); }, "", "orthographic");
    expectError([&] { CameraRays(CameraMove(a, b), 1.0); }, "", "orthographic");
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

const std::string kPose = R"("origin": [0,0,0], "forward": [0,0,-1], "up": [0,1,0])";

/// A file whose "cam" and whose second of three frames have more keys.
std::string cameraWith(const std::string& common, const std::string& own) {
    const std::string frame = "{" + kPose + "}";
    return R"({"cam": {"fps": 24, )" + common + R"("frames": [)" + frame + ", {" + own + kPose +
           "}, " + frame + "]}}";
}

TEST(CameraFile, ReadsLensesShiftsAndPlanesOfAllFramesAndOfOne) {
    const TemporaryFolder folder;
    const CameraTrack track = readCameraFile(folder.write(
        "c.json",
        cameraWith(R"("yfov": 1, "shift": [0.1, -0.2], "pixel_aspect": 2, "near": 0.5,)"
                   R"("lens": {"radius": 0.01, "focus": 3},)",
                   R"("height": 4, "far": 9, "lens": {"radius": 0, "focus": 2, "blades": 7,)"
                   R"( "rotation": 0.5},)")));
    const Camera& first = track.frames[0];
    EXPECT_EQ(first.shiftX, 0.1);
    EXPECT_EQ(first.shiftY, -0.2);
    EXPECT_EQ(first.pixelAspect, 2);
    EXPECT_EQ(first.near, 0.5);
    EXPECT_EQ(first.far, std::numeric_limits<double>::infinity());
    EXPECT_EQ(first.lens.radius, 0.01);
    EXPECT_EQ(first.lens.blades, 0);
    EXPECT_EQ(first.height, 0);
    const Camera& second = track.frames[1];
    EXPECT_EQ(second.height, 4);
    EXPECT_EQ(second.far, 9);
    EXPECT_EQ(second.shiftX, 0.1);
    EXPECT_EQ(second.lens.blades, 7);
    EXPECT_EQ(second.lens.rotation, 0.5);
    EXPECT_EQ(second.lens.focus, 2);
    EXPECT_EQ(track.frames[2].fovY, 1);
    EXPECT_EQ(cameraAtTime(track, -3).far, first.far);
    EXPECT_EQ(cameraAtTime(track, 2).far, 9);
    expectError([&] { cameraAtTime(track, 1.5); }, "", "orthographic");
}

TEST(CameraJson, HasTheKeysOfAFrameAndNoOthers) {
    const auto of = [](const std::string& keys) {
        return cameraOf(nlohmann::json::parse("{" + keys + kPose + "}"), "camera");
    };
    EXPECT_EQ(of(R"("yfov": 0.5, "lens": {"radius": 1, "focus": 2},)").lens.focus, 2);
    EXPECT_EQ(of(R"("height": 2,)").height, 2);
    expectError([&] { of(""); }, "camera", "has no yfov");
    expectError([&] { of(R"("yfov": 0.5, "roll": 1,)"); }, "camera", "has the unknown key roll");
    expectError([] { cameraOf(3, "camera"); }, "camera", "holds no JSON object");
}

TEST(CameraFile, RefusesLensesShiftsAndPlanesOutOfRange) {
    const TemporaryFolder folder;
    const auto refuses = [&](const std::string& key, const std::string& cause) {
        const auto path = folder.write("c.json", cameraWith(R"("yfov": 1,)", key + ","));
        expectError([&] { readCameraFile(path); }, path.string(), cause);
    };
    refuses(R"("height": 0)", "cam.frames[1].height is 0, expected metres in (0,");
    refuses(R"("yfov": 1, "height": 2)", "height is 2, expected either yfov");
    refuses(R"("shift": 1)", "shift is 1, expected two finite numbers");
    refuses(R"("shift": [0, 1e9])", "shift is [0,1000000000.0], expected numbers up to 100");
    refuses(R"("pixel_aspect": 0)", "pixel_aspect is 0, expected a ratio");
    refuses(R"("near": -1)", "near is -1, expected metres, 0 or more");
    refuses(R"("near": 3, "far": 2)", "has near 3 and far 2, expected near below far");
    refuses(R"("far": "all")", "far is \"all\", expected metres above 0");
    refuses(R"("lens": 3)", "lens is 3, expected an object");
    refuses(R"("lens": {"radius": 1})", "has no cam.frames[1].lens.focus");
    refuses(R"("lens": {"radius": -1, "focus": 1})", "lens.radius is -1");
    refuses(R"("lens": {"radius": 1, "focus": 0})", "lens.focus is 0, expected metres above 0");
    refuses(R"("lens": {"radius": 1, "focus": 1, "blades": 2})",
            "lens.blades is 2, expected 0, or a whole number from 3 to 64");
    const auto path = folder.write("c.json", cameraWith("", R"("height": 2,)"));
    expectError([&] { readCameraFile(path); }, path.string(), "has no cam.yfov");
}

TEST(CameraFile, RefusesKeysThatItDoesNotKnow) {
    const TemporaryFolder folder;
    const auto refuses = [&](const std::string& common, const std::string& own,
                             const std::string& cause) {
        const auto path = folder.write("c.json", cameraWith(R"("yfov": 1,)" + common, own));
        expectError([&] { readCameraFile(path); }, path.string(), cause);
    };
    refuses(R"("shfit": [0, 0.1],)", "", "has the unknown key cam.shfit, did you mean shift?");
    refuses("", R"("roll": 0.1,)", "has the unknown key cam.frames[1].roll");
    refuses(R"("lens": {"radius": 1, "focus": 2, "blade": 5},)", "",
            "has the unknown key cam.lens.blade, did you mean blades?");
    refuses("", R"("t": 0, "fps": 24,)", "has the unknown key cam.frames[1].fps");
    EXPECT_NO_THROW(
        readCameraFile(folder.write("c.json", R"({"notes": "by hand", )" + kGood.substr(1))));
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
