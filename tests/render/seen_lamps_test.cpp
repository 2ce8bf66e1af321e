// Lamps that cameras see: each adds its radiance where a camera's ray meets it, and nowhere else;
// closed forms of what pictures then have more, by light group, too.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "render/frame/integrator.h"
#include "render/library/lit_stage.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

constexpr int kFilmSize = 16;       // of the picture, in pixels
constexpr double kViewWidth = 4;    // of the view
constexpr float kWallGlow = 0.25f;  // of the wall

/// A wall that emits and reflects nothing, four metres before the camera.
TriangleMesh glowingWall() {
    TriangleMesh mesh;
    test::addQuad(mesh, {-9, -9, -2}, {9, -9, -2}, {9, 9, -2}, {-9, 9, -2});
    Material glowing;
    glowing.name = "wall";
    glowing.albedo = Rgb(0.0f);
    glowing.finish.emission = Rgb(kWallGlow);
    mesh.materials = {glowing};
    mesh.parts = {{0, 2, 0}};
    return mesh;
}

Camera wallCamera() {
    Camera camera = lookAt({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 1);
    camera.height = kViewWidth;
    return camera;
}

/// An area of a square metre and of radiance 1, 2, 3 that faces the camera.
Lamp seenPanel() {
    Lamp lamp;
    lamp.name = "panel";
    lamp.form = Lamp::Form::rectangle;
    lamp.strength = Rgb(1, 2, 3);
    lamp.direction = Vec3d(0, 0, 1);
    lamp.halfWidth = Vec3d(0.5, 0, 0);
    lamp.halfHeight = Vec3d(0, 0.5, 0);
    lamp.seenByCamera = true;
    return lamp;
}

/// A disc of that radiance.
Lamp seenBulb(double radius) {
    Lamp lamp;
    lamp.name = "bulb";
    lamp.radius = radius;
    lamp.strength = Rgb(1, 2, 3) * static_cast<float>(kPi * radius * radius);
    lamp.seenByCamera = true;
    return lamp;
}

Lamp seenSpot(double radius, const Vec3d& direction) {
    Lamp lamp = seenBulb(radius);
    lamp.direction = direction;
    lamp.cone = LampCone{std::cos(0.3), std::cos(0.6), true};
    return lamp;
}

/// Radius of a bulb in the middle. Two metres from the camera it shows a disc: of rays whose
/// starts it faces, h from its axis, those of h^4 + 4 h^2 < 4 r^2.
constexpr double kRadius = 0.6;
const double kDisc = kPi * 2 * (std::sqrt(1 + kRadius * kRadius) - 1);

/// What is asked for of a picture.
struct SeenPicture {
    Camera view = wallCamera();
    RenderOptions options{};
    std::vector<LightGroupRule> groups{};
};

Film filmOfWall(const Scene& scene, const SeenPicture& wanted, const char* estimator = "mis",
                const ShadowCache* cache = nullptr,
                const Image& sky = test::constantMap(Rgb(0.0f))) {
    LightingOptions lighting;
    lighting.groups = wanted.groups;
    LitStage lit(scene, cache, findEstimator(estimator), lighting);
    const Environment environment = test::environmentOf(sky);
    lit.setEnvironment(environment);
    RenderOptions options = wanted.options;
    options.width = options.height = kFilmSize;
    options.filter = FilterKind::box;
    RenderStats stats;
    return lit.plan(wanted.view, 1, options, stats).film(stats);
}

Film filmOfWall(const TriangleMesh& mesh, SeenPicture wanted = {}, int cameraRays = 64) {
    const Scene scene(mesh);
    wanted.options.cameraRays = cameraRays;
    wanted.options.samples = 1;
    return filmOfWall(scene, wanted);
}

TriangleMesh wallWith(std::vector<Lamp> lamps) {
    TriangleMesh mesh = glowingWall();
    mesh.lamps = std::move(lamps);
    return mesh;
}

Rgb meanSeen(const Film& film, Rgb RayValues::*value = &RayValues::color) {
    Rgb sum(0, 0, 0);
    for (const Pixel& pixel : film.pixels) sum += pixel.*value;
    return sum * (1 / static_cast<float>(film.pixels.size()));
}

/// Square metres of radiance (1, 2, 3) that a picture shows before the wall; -1: of another colour.
double areaShown(const Film& film) {
    const Rgb more =
        (meanSeen(film) - Rgb(kWallGlow)) * static_cast<float>(kViewWidth * kViewWidth);
    if (std::abs(more.y - 2 * more.x) > 1e-4f || std::abs(more.z - 3 * more.x) > 1e-4f) return -1;
    return static_cast<double>(more.x);
}

TEST(SeenLamps, ShowTheirRadianceOnTheirArea) {
    EXPECT_NEAR(areaShown(filmOfWall(wallWith({seenPanel()}))), 1, 1e-4);
    Lamp ellipse = seenPanel();
    ellipse.form = Lamp::Form::ellipse;
    ellipse.strength *= static_cast<float>(kPi / 4);
    EXPECT_NEAR(areaShown(filmOfWall(wallWith({ellipse}))), kPi / 4, 0.01);
    EXPECT_NEAR(areaShown(filmOfWall(wallWith({seenBulb(kRadius)}))), kDisc, 0.01);
    EXPECT_NEAR(areaShown(filmOfWall(wallWith({seenSpot(kRadius, {0, 0, 1})}))), kDisc, 0.01);
    // At a falloff's middle.
    const double middle = std::acos((std::cos(0.3) + std::cos(0.6)) / 2);
    const Lamp askew = seenSpot(kRadius, {std::sin(middle), 0, std::cos(middle)});
    EXPECT_NEAR(areaShown(filmOfWall(wallWith({askew}))), kDisc / 2, 0.01);
}

// As slats at right angles let through what passes one of them.
TEST(SeenLamps, AreDarkerFromTheSideByTheirSpread) {
    for (const double angle : {0.0, 0.2, 0.6}) {
        Lamp panel = seenPanel();
        panel.spread = 1;
        panel.direction = Vec3d(std::sin(angle), 0, std::cos(angle));
        panel.halfWidth = Vec3d(0.5 * std::cos(angle), 0, -0.5 * std::sin(angle));
        const double left = std::max(0.0, 1 - std::tan(angle) / std::tan(0.5));
        EXPECT_NEAR(areaShown(filmOfWall(wallWith({panel}))), left * std::cos(angle), 0.01)
            << angle;
    }
}

TEST(SeenLamps, AddUp) {
    Lamp behind = seenPanel();
    behind.position.z = -1;
    Lamp dimmed = seenPanel();
    dimmed.gain = Rgb(0.5f);
    EXPECT_NEAR(areaShown(filmOfWall(wallWith({seenPanel(), behind, dimmed, seenBulb(kRadius)}))),
                2.5 + kDisc, 0.01);
}

TEST(SeenLamps, ShowNothingElsewhere) {
    Lamp hidden = seenPanel();
    hidden.seenByCamera = false;
    Lamp back = seenPanel();
    back.direction = Vec3d(0, 0, -1);
    Lamp behindWall = seenPanel();
    behindWall.position.z = -3;
    Lamp behindCamera = seenBulb(kRadius);
    behindCamera.position.z = 3;
    Lamp off = seenPanel();
    off.gain = Rgb(0.0f);
    Lamp point = seenBulb(kRadius);
    point.radius = 0;
    Lamp sun = seenBulb(0);
    sun.form = Lamp::Form::sun;
    sun.angle = 1;
    sun.direction = Vec3d(0, 0, 1);
    for (const Lamp& lamp :
         {hidden, back, behindWall, behindCamera, off, point, sun, seenSpot(kRadius, {0, 0, -1})})
        EXPECT_EQ(areaShown(filmOfWall(wallWith({lamp}))), 0);
}

// The middle of each pixel on a diagonal lies on the edge of two of the panel's triangles.
TEST(SeenLamps, AreMetOnceOnEdgesOfTheirTriangles) {
    const Film film = filmOfWall(wallWith({seenPanel()}), {}, 1);
    for (int y = 6; y < 10; ++y)
        for (int x = 6; x < 10; ++x)
            EXPECT_NEAR(film.pixels[static_cast<std::size_t>(y * kFilmSize + x)].color.x,
                        1 + kWallGlow, 1e-5f)
                << x << " " << y;
}

// On the film a sun's disc has the radius tan(angle / 2); its irradiance is that of the strength.
TEST(SeenLamps, OfTheSkyAreSeenBeforeIt) {
    SeenPicture wanted;
    wanted.view = lookAt({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 1);
    wanted.options.transparent = true;
    Lamp sun = seenPanel();
    sun.form = Lamp::Form::sun;
    sun.direction = Vec3d(0, 0, -1);
    sun.angle = 0.5;
    const Film film = filmOfWall(wallWith({sun}), wanted);
    const double share = kPi * std::pow(std::tan(0.25) / (2 * std::tan(0.5)), 2);
    const double radiance = 1 / (kPi * std::pow(std::sin(0.25), 2));
    EXPECT_NEAR(static_cast<double>(meanSeen(film).x) / (share * radiance), 1, 0.01);
    EXPECT_EQ(meanSeen(film, &RayValues::emission), meanSeen(film));
    EXPECT_EQ(meanSeen(film, &RayValues::environment), Rgb(0, 0, 0));
    for (const Pixel& pixel : film.pixels) EXPECT_EQ(pixel.coverage, 0);
    // Suns alone are seen beyond the far plane.
    wanted.view.far = 1;
    EXPECT_EQ(meanSeen(filmOfWall(wallWith({sun}), wanted)), meanSeen(film));
    wanted.view = wallCamera();
    Lamp beyond = seenPanel();
    for (const double far : {1.9, 2.1}) {
        wanted.view.far = far;
        EXPECT_EQ(meanSeen(filmOfWall(wallWith({beyond}), wanted)).x > 0, far > 2);
    }
}

TEST(SeenLamps, AreOfTheirLightGroups) {
    SeenPicture wanted;
    wanted.groups = {{"", "*"}};
    const Film film = filmOfWall(wallWith({seenPanel(), seenBulb(kRadius)}), wanted);
    const Film alone = filmOfWall(wallWith({seenBulb(kRadius)}), wanted);
    ASSERT_EQ(film.groups, (std::vector<std::string>{"sky", "panel", "bulb", "wall", "rest"}));
    std::array<Rgb, 5> mean{};
    mean.fill(Rgb(0, 0, 0));
    for (std::size_t i = 0; i < film.pixels.size(); ++i) {
        Rgb sum(0, 0, 0);
        for (std::size_t g = 0; g < mean.size(); ++g) {
            sum += film.groupColors[i][g];
            mean[g] += film.groupColors[i][g] * (1 / static_cast<float>(film.pixels.size()));
        }
        EXPECT_LT((sum - film.pixels[i].color).length(), 1e-4f);
    }
    EXPECT_NEAR(mean[1].x, 1 / (kViewWidth * kViewWidth), 1e-5);
    EXPECT_LT((mean[2] - (meanSeen(alone) - Rgb(kWallGlow))).length(), 1e-5f);
    EXPECT_NEAR(mean[3].x, kWallGlow, 1e-5f);
    EXPECT_EQ(mean[0] + mean[4], Rgb(0, 0, 0));
}

// Rays are tinted by panes before a lamp, and by none behind it.
TEST(SeenLamps, AreTintedByPanesBeforeThem) {
    const Rgb green(0.5f, 0.9f, 0.6f);
    const auto emission = [&](float pane) {
        TriangleMesh mesh = wallWith({seenPanel()});
        mesh.lamps[0].halfWidth *= 8;
        mesh.lamps[0].halfHeight *= 8;
        mesh.lamps[0].strength = Rgb(64.0f);
        mesh.materials[0].finish.emission = Rgb(0.0f);
        test::addQuad(mesh, {-9, -9, pane}, {9, -9, pane}, {9, 9, pane}, {-9, 9, pane});
        Material glass;
        glass.albedo = green;
        glass.finish.gloss = Gloss{.metallic = 0, .roughness = 0};
        glass.finish.transmission = 1;
        mesh.materials.push_back(glass);
        mesh.parts.push_back({2, 2, 1});
        return meanSeen(filmOfWall(mesh), &RayValues::emission);
    };
    EXPECT_LT((emission(-1) - Rgb(1.0f)).length(), 1e-4f);
    EXPECT_LT((emission(1) - green * 0.96f).length(), 0.02f);
}

// Pictures that show a prediction show lamps, too: they add as much to each pixel.
TEST(SeenLamps, ArePartOfPreviews) {
    TriangleMesh mesh = wallWith({seenPanel()});
    mesh.materials[0].albedo = Rgb(0.5f);
    const test::World world(mesh, test::constantMap(Rgb(1.0f)), {.spacing = 2, .level = 2});
    TriangleMesh hidden = mesh;
    hidden.lamps[0].seenByCamera = false;
    const Scene without(hidden);
    for (const int samples : {0, 4}) {
        SeenPicture wanted;
        wanted.options.preview = true;
        wanted.options.samples = samples;
        const auto shows = [&](const Scene& scene) {
            return meanSeen(filmOfWall(scene, wanted, "cache", &world.cache.cache(),
                                       test::constantMap(Rgb(1.0f))));
        };
        const Rgb more = shows(world.scene) - shows(without);
        EXPECT_LT((more * static_cast<float>(kViewWidth * kViewWidth) - Rgb(1, 2, 3)).length(),
                  0.02f)
            << samples;
    }
}

}  // namespace
}  // namespace shadowcache
