// Camera rays choose one of all that they may pass by a given chance, and count by a share: closed
// forms of what they show, and pictures in which stratified chances leave no noise.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "common/trace/scene.h"
#include "render/frame/integrator.h"
#include "render/library/lit_stage.h"
#include "tests/support/glazed_floor.h"

namespace shadowcache {
namespace {

using test::glass, test::glazedFloor, test::passed;

const Rgb kGreen(0.5f, 0.9f, 0.6f);
constexpr float kVeil = 0.3f;  // opacity

/// Two sheets of green glass at heights 1 and 1.1, a veil at 2, all above a floor.
TriangleMesh veiledGlass() {
    TriangleMesh mesh = glazedFloor(2, glass(kGreen));
    test::addFloor(mesh, 2, -3, 3, -3, 3);
    Material veil;
    veil.blends = true;
    veil.opacity = kVeil;
    mesh.materials.push_back(veil);
    mesh.parts.push_back({6, 2, 2});
    return mesh;
}

/// What rays of evenly spaced chances show of the surfaces at a height.
struct Shown {
    double rays = 0;   // that show them, of all
    Vec3d light{0.0};  // they count for, if each surface sends 1
};

constexpr int kChances = 1 << 14;

/// By height, from the floor up in tenths; the last is nothing. Down at the angle of a cosine.
std::array<Shown, 22> shownBy(const Scene& scene, double cosine, float leastOfPanes,
                              bool byShare = true) {
    const auto sine = static_cast<float>(std::sqrt(1 - cosine * cosine));
    const Vec3f direction(sine, -static_cast<float>(cosine), 0);
    // Through the floor's middle.
    const Vec3f origin = Vec3f(-scene.mesh().origin) - direction * static_cast<float>(3 / cosine);
    std::array<Shown, 22> shown{};
    CameraPacket packet{};
    std::array<Hit, RayPacket::kSize> hits;
    for (int first = 0; first < kChances; first += RayPacket::kSize) {
        for (int i = 0; i < RayPacket::kSize; ++i)
            packet.set(i, origin, direction,
                       (static_cast<float>(first + i) + 0.5f) / static_cast<float>(kChances), 1e9);
        scene.look(packet, RayPacket::kSize, leastOfPanes, hits.data());
        for (const Hit& hit : hits) {
            const double height = static_cast<double>(hit.position.y) + scene.mesh().origin.y;
            const long number = hit.found ? std::lround(10 * height) : 21;
            Shown& at = shown[static_cast<std::size_t>(number)];
            at.rays += 1.0 / kChances;
            at.light +=
                Vec3d(hit.tint) * (static_cast<double>(byShare ? hit.share : 1.0f) / kChances);
        }
    }
    return shown;
}

struct Crossed {
    std::string name;
    double cosine;
    float leastOfPanes;
};

class CrossedSurfaces : public testing::TestWithParam<Crossed> {};

TEST_P(CrossedSurfaces, AreShownByTheirChances) {
    const auto& [name, cosine, least] = GetParam();
    const TriangleMesh mesh = veiledGlass();
    const Scene scene(mesh);
    const auto shown = shownBy(scene, cosine, least);
    const Vec3d sheet = Vec3d(kGreen) * passed(cosine);
    const double stopped = 1 - Vec3d(0.2126, 0.7152, 0.0722).dot(sheet);
    const double veil = static_cast<double>(kVeil);
    const Vec3d below(1 - veil);
    const auto expectNear = [](const Vec3d& found, const Vec3d& wanted) {
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], wanted[c], 1e-3) << c;
    };
    expectNear(shown[20].light, Vec3d(veil));
    expectNear(shown[11].light, below * stopped);
    expectNear(shown[10].light, below * sheet * stopped);
    expectNear(shown[0].light, below * sheet * sheet);
    EXPECT_EQ(shown.back().rays, 0);
    const double atPanes = (1 - veil) * stopped * (2 - stopped);
    EXPECT_NEAR(shown[11].rays + shown[10].rays, std::max(atPanes, static_cast<double>(least)),
                1e-3);
    if (atPanes > static_cast<double>(least)) return;
    // Control: each ray as one.
    EXPECT_GT(shownBy(scene, cosine, least, false)[11].light.x, 1.1 * shown[11].light.x);
}

INSTANTIATE_TEST_SUITE_P(Rays, CrossedSurfaces,
                         testing::Values(Crossed{"asTheyAre", 0.999, 0},
                                         Crossed{"panesRaised", 0.999, 0.6f},
                                         Crossed{"obliquePanesRaised", 0.7, 0.7f},
                                         Crossed{"enoughPanes", 0.7, 0.25f}),
                         [](const auto& crossed) { return crossed.param.name; });

// Next to no light takes next to no ray: eight times as many as stop there, at most.
TEST(CrossedSurfaces, ThatStopNextToNothingAreSeldomShown) {
    Material clear = glass(Rgb(1));
    clear.finish.gloss->ior = 1.1f;
    const TriangleMesh mesh = glazedFloor(1, clear);
    const Scene scene(mesh);
    const double stopped = std::pow(0.1 / 2.1, 2);
    const auto shown = shownBy(scene, 0.999, 0.25f);
    EXPECT_NEAR(shown[10].rays, 8 * stopped, 2e-3);
    EXPECT_NEAR(shown[10].light.x, stopped, 1e-3);
    // Control: without a limit it would be a quarter.
    EXPECT_LT(shown[10].rays, 0.1);
}

// What moves is in front of the set or behind it, and a placed sheet is one that is there itself.
TEST(CrossedSurfaces, MayMoveAndBePlaced) {
    constexpr double kCosine = 0.8;
    TriangleMesh floor = glazedFloor(1, glass(kGreen));
    TriangleMesh over = glazedFloor(2, glass(kGreen));
    const TriangleMesh together = over;
    over.triangles.erase(over.triangles.begin(), over.triangles.begin() + 4);
    over.parts = {{0, 2, 1}};
    const TriangleMesh placed = glazedFloor(2, glass(kGreen), true);
    Scene still(floor);
    const Scene moving(over), all(together), copies(placed);
    still.setMoving(&moving);
    const auto wanted = shownBy(all, kCosine, 0.5f);
    for (const Scene* scene : {static_cast<const Scene*>(&still), &copies}) {
        const auto found = shownBy(*scene, kCosine, 0.5f);
        for (const std::size_t at : {0u, 10u, 11u}) {
            EXPECT_NEAR(found[at].rays, wanted[at].rays, 2e-3) << at;
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(found[at].light[c], wanted[at].light[c], 1e-3) << at;
        }
    }
    // Control: without what moves.
    still.setMoving(nullptr);
    EXPECT_LT(shownBy(still, kCosine, 0.5f)[11].rays, 0.1);
}

TEST(CrossedSurfaces, CoverAsMuchAsTheyStop) {
    TriangleMesh mesh = veiledGlass();
    const Scene scene(mesh);
    CameraPacket packet{};
    Hit hit;
    const auto covered = [&](float x, double reach) {
        packet.set(0, Vec3f(Vec3d(static_cast<double>(x), 3, 0.3) - mesh.origin), {0, -1, 0}, 0.99f,
                   reach);
        scene.look(packet, 1, 0.25f, &hit);
        return static_cast<double>(hit.covered);
    };
    const double sheet = Vec3d(0.2126, 0.7152, 0.0722).dot(Vec3d(kGreen)) * passed(1);
    const double veil = 1 - static_cast<double>(kVeil);
    EXPECT_EQ(covered(0, 9), 1);
    EXPECT_NEAR(covered(2, 9), 1 - veil * sheet * sheet, 1e-4);
    // Nothing counts beyond the reach.
    EXPECT_NEAR(covered(0, 1.95), 1 - veil * sheet, 1e-4);
    EXPECT_NEAR(covered(0, 1.5), 1 - veil, 1e-6);
    EXPECT_EQ(covered(0, 0.5), 0);
    EXPECT_EQ(covered(5, 9), 0);
}

/// Looks straight down from below the veil, all but along one line, at no edge of a triangle.
Film filmThroughGlass(const TriangleMesh& mesh, int cameraRays, bool transparent) {
    const Scene scene(mesh);
    LitStage lit(scene, nullptr, findEstimator("mis"), {});
    const Environment environment = test::environmentOf(test::constantMap(Rgb(0.0f)));
    lit.setEnvironment(environment);
    RenderOptions options;
    options.width = options.height = 24;
    options.cameraRays = cameraRays;
    options.samples = 1;
    options.transparent = transparent;
    RenderStats stats;
    return lit.plan(lookAt({0.3, 1.9, 0}, {0.3, 0, 0}, {0, 0, 1}, 0.02), 1, options, stats)
        .film(stats);
}

/// Greatest difference of a value of the pixels to one that all should have.
template <class Value>
double farthest(const Film& film, double wanted, const Value& value) {
    double most = 0;
    for (const Pixel& pixel : film.pixels)
        most = std::max(most, std::abs(static_cast<double>(value(pixel)) - wanted));
    return most;
}

// Of sixteen rays four show the sheet, of a black sky, and twelve the floor.
TEST(LookThrough, LeavesNoNoiseWhereAllRaysOfAPixelCrossTheSame) {
    TriangleMesh mesh = glazedFloor(1, glass(Rgb(1)));
    mesh.materials[0].finish.unlit = true;
    mesh.materials[0].albedo = Rgb(1);
    const auto red = [](const Pixel& pixel) { return pixel.color.x; };
    EXPECT_LT(farthest(filmThroughGlass(mesh, 16, false), passed(1), red), 1e-3);
    // Control: three rays show it by chance, most of them not at all.
    EXPECT_GT(farthest(filmThroughGlass(mesh, 3, false), passed(1), red), 0.2);
    // Positions and all the like are those of the rays that meet something.
    const auto heights = [](const Pixel& pixel) { return pixel.position.y; };
    EXPECT_LT(farthest(filmThroughGlass(mesh, 16, false), 1 - passed(1), heights), 1e-3);
}

TEST(LookThrough, AlphaIsThatOfTheGlass) {
    TriangleMesh mesh = glazedFloor(2, glass(Rgb(1)));
    const auto alpha = [](const Pixel& pixel) { return pixel.alpha; };
    EXPECT_EQ(farthest(filmThroughGlass(mesh, 3, true), 1, alpha), 0);
    // Without the floor.
    mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + 2);
    mesh.parts = {{0, 4, 1}};
    EXPECT_LT(farthest(filmThroughGlass(mesh, 3, true), 1 - passed(1) * passed(1), alpha), 1e-3);
}

// A lamp that cameras see, behind glass: in its colour. Another before it is not.
TEST(LookThrough, LampsHaveTheColorOfTheGlassBeforeThem) {
    for (const double height : {0.5, 1.5}) {
        TriangleMesh mesh = glazedFloor(1, glass(kGreen));
        mesh.materials[0].albedo = Rgb(0.0f);
        Lamp lamp;
        lamp.name = "panel";
        lamp.form = Lamp::Form::rectangle;
        lamp.strength = Rgb(1, 2, 3);
        lamp.position = Vec3d(0, height, 0);
        lamp.direction = Vec3d(0, 1, 0);
        lamp.halfWidth = Vec3d(0.5, 0, 0);
        lamp.halfHeight = Vec3d(0, 0, 0.5);
        lamp.seenByCamera = true;
        mesh.lamps = {lamp};
        const Film film = filmThroughGlass(mesh, 16, false);
        const Vec3d pane = height < 1 ? Vec3d(kGreen) * passed(1) : Vec3d(1);
        for (int c = 0; c < 3; ++c) {
            double sum = 0;
            for (const Pixel& pixel : film.pixels)
                sum += static_cast<double>(pixel.emission[c]) / 576;
            EXPECT_NEAR(sum, static_cast<double>(c + 1) * pane[c], 0.01) << height << " " << c;
        }
    }
}

}  // namespace
}  // namespace shadowcache
