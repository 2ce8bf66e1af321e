// Light groups: together they are the picture, whatever finds and predicts the light; each is the
// picture of its light alone, with all that bounces; gains after the render are those before it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "render/frame/integrator.h"
#include "render/library/lit_stage.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

Material surface(const std::string& name, const Rgb& albedo) {
    Material material;
    material.name = name;
    material.albedo = albedo;
    return material;
}

/// Triangles from here to the end of the mesh become a part of a new material.
void addPart(TriangleMesh& mesh, const Material& material) {
    const std::uint32_t first =
        mesh.parts.empty() ? 0 : mesh.parts.back().firstTriangle + mesh.parts.back().triangleCount;
    mesh.parts.push_back({first, static_cast<std::uint32_t>(mesh.triangles.size()) - first,
                          static_cast<int>(mesh.materials.size())});
    mesh.materials.push_back(material);
}

/// A room with a window, a glossy box, a coloured pane, two panels that shine, and two lamps.
TriangleMesh litRoom() {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -2, 2, -2, 2);
    test::addFloor(mesh, 2, -2, 2, -2, 2);
    test::addQuad(mesh, {-2, 0, -2}, {-2, 2, -2}, {-2, 2, 2}, {-2, 0, 2});
    test::addQuad(mesh, {-2, 0, -2}, {2, 0, -2}, {2, 2, -2}, {-2, 2, -2});
    test::addQuad(mesh, {2, 0, -2}, {2, 2, -2}, {2, 2, -0.5f}, {2, 0, -0.5f});
    addPart(mesh, surface("walls", Rgb(0.7f, 0.6f, 0.5f)));
    test::addBox(mesh, {-0.8f, 0, -0.6f}, {0.1f, 0.8f, 0.4f});
    Material box = surface("box", Rgb(0.5f));
    box.finish.gloss = Gloss{.metallic = 0.5f, .roughness = 0.2f};
    addPart(mesh, box);
    test::addQuad(mesh, {-1, 1.9f, -1}, {-0.5f, 1.9f, -1}, {-0.5f, 1.9f, -0.5f}, {-1, 1.9f, -0.5f});
    Material panel = surface("panel", Rgb(0.2f));
    panel.finish.emission = Rgb(8, 6, 4);
    addPart(mesh, panel);
    test::addQuad(mesh, {-1.9f, 0.5f, 0}, {-1.9f, 1, 0}, {-1.9f, 1, 1}, {-1.9f, 0.5f, 1});
    Material screen = surface("screen", Rgb(0.2f));
    screen.finish.emission = Rgb(1, 3, 5);
    addPart(mesh, screen);
    test::addQuad(mesh, {0.6f, 0, -1}, {0.6f, 1.5f, -1}, {0.6f, 1.5f, 0}, {0.6f, 0, 0});
    Material pane = surface("pane", Rgb(0.9f, 0.6f, 0.9f));
    pane.finish.gloss = Gloss{.metallic = 0, .roughness = 0.1f};
    pane.finish.transmission = 1;
    addPart(mesh, pane);
    Lamp bulb;
    bulb.name = "bulb";
    bulb.strength = Rgb(0.3f, 0.3f, 0.2f);
    bulb.position = {0.8, 1.2, -1.2};
    bulb.radius = 0.05;
    Lamp spot = bulb;
    spot.name = "spot";
    spot.position = {-1.5, 1.7, -1.5};
    spot.direction = Vec3d(0.5, -1, 0.5).normalized();
    spot.cone = LampCone{std::cos(0.4), std::cos(0.7), true};
    mesh.lamps = {bulb, spot};
    return mesh;
}

/// Coarse: what groups add up to does not depend on the cache.
constexpr BakeOptions kBake{.spacing = 0.5, .level = 3, .rays = 8};

Image sky() {
    return test::gradientMap(32, 16, {0.3, 0.6, 0.4});
}

Camera camera() {
    return lookAt({1.5, 1.2, 1.4}, {-0.4, 0.75, -0.2}, {0, 1, 0}, 1.2);
}

/// What is asked for of a picture.
struct Wanted {
    std::string name;
    const char* estimator = "cache";
    int bounces = 3;
    std::function<void(RenderOptions&)> change = [](RenderOptions&) {};
    std::vector<LightGroupRule> groups{{"", "*"}};
};

/// Films of what is asked for, which is lit and planned once.
class Films {
public:
    Films(const Scene& scene, const ShadowCache* cache, const Environment& environment,
          const Wanted& wanted)
        : lit_(scene, findEstimator(wanted.estimator).needsCache ? cache : nullptr,
               findEstimator(wanted.estimator), lightingOf(wanted)) {
        lit_.setEnvironment(environment);
        RenderOptions options;
        options.width = options.height = 14;
        options.cameraRays = options.samples = 4;
        options.bounces = wanted.bounces;
        wanted.change(options);
        RenderStats stats;
        picture_.emplace(lit_.plan(camera(), 1, options, stats));
    }

    Film film(std::uint64_t seed) const {
        RenderStats stats;
        return film(seed, stats);
    }

    Film film(std::uint64_t seed, RenderStats& stats) const {
        FrameRequest request = picture_->request();
        request.options.seed = seed;
        return render(request, stats);
    }

private:
    static LightingOptions lightingOf(const Wanted& wanted) {
        LightingOptions lighting;
        lighting.bounces = wanted.bounces;
        lighting.groups = wanted.groups;
        return lighting;
    }

    LitStage lit_;
    std::optional<Picture> picture_;
};

Film filmOf(const Scene& scene, const ShadowCache* cache, const Environment& environment,
            const Wanted& wanted) {
    return Films(scene, cache, environment, wanted).film(1);
}

std::size_t numberOf(const Film& film, const std::string& group) {
    const auto found = std::ranges::find(film.groups, group);
    EXPECT_NE(found, film.groups.end()) << group;
    return static_cast<std::size_t>(found - film.groups.begin());
}

/// Mean luminance of a film's group, by its number.
double meanOf(const Film& film, std::size_t group) {
    double sum = 0;
    for (std::size_t i = 0; i < film.pixels.size(); ++i)
        sum += static_cast<double>(film.groupColors[i][group].dot(Rgb(1, 1, 1)));
    return sum / static_cast<double>(film.pixels.size());
}

double meanOf(const Film& film) {
    double sum = 0;
    for (const Pixel& pixel : film.pixels)
        sum += static_cast<double>(pixel.color.dot(Rgb(1, 1, 1)));
    return sum / static_cast<double>(film.pixels.size());
}

/// The greatest difference of a pixel and the sum of its groups, in roundings of what is summed.
double misfitOf(const Film& film) {
    double most = 0;
    for (std::size_t i = 0; i < film.pixels.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            double sum = 0, size = 1e-3;
            for (const Rgb& light : film.groupColors[i]) {
                sum += static_cast<double>(light[c]);
                size += std::abs(static_cast<double>(light[c]));
            }
            most = std::max(most, std::abs(sum - static_cast<double>(film.pixels[i].color[c])) /
                                      (size * 0x1p-23));
        }
    return most;
}

/// Roundings that a path of some bounces may add up.
constexpr double kRoundings = 200;

class GroupsOf : public testing::TestWithParam<Wanted> {};

TEST_P(GroupsOf, AddUpToThePictureWhichStaysAsItIs) {
    const test::World world(litRoom(), sky(), kBake);
    const ShadowCache* cache = &world.cache.cache();
    const Film film = filmOf(world.scene, cache, world.environment, GetParam());
    EXPECT_EQ(film.groups,
              (std::vector<std::string>{"sky", "bulb", "spot", "panel", "screen", "rest"}));
    EXPECT_LT(misfitOf(film), kRoundings);
    for (const char* group : {"sky", "bulb", "spot", "panel", "screen"})
        EXPECT_GT(meanOf(film, numberOf(film, group)), 1e-3 * meanOf(film)) << group;
    EXPECT_EQ(meanOf(film, numberOf(film, "rest")), 0);
    Wanted without = GetParam();
    without.groups.clear();
    const Film alone = filmOf(world.scene, cache, world.environment, without);
    EXPECT_TRUE(alone.groupColors.empty());
    for (std::size_t i = 0; i < film.pixels.size(); ++i)
        ASSERT_EQ(film.pixels[i].color, alone.pixels[i].color) << i;
}

INSTANTIATE_TEST_SUITE_P(
    Pictures, GroupsOf,
    testing::Values(Wanted{"cached"}, Wanted{"direct", "cache", 0},
                    Wanted{"unlimited", "cache", -1}, Wanted{"mis", "mis"},
                    Wanted{"byChance", "cosine"}, Wanted{"dome", "dome"},
                    Wanted{"predicted", "cache", 3, [](RenderOptions& o) { o.samples = 0; }},
                    Wanted{"previewed", "cache", 3,
                           [](RenderOptions& o) {
                               o.samples = 0;
                               o.preview = true;
                               o.crop = FilmRectangle{3, 2, 5, 7};
                           }},
                    Wanted{"clamped", "cache", 3, [](RenderOptions& o) { o.clampIndirect = 0.2f; }},
                    Wanted{"cropped", "cache", 3,
                           [](RenderOptions& o) {
                               o.crop = FilmRectangle{3, 2, 5, 7};
                           }},
                    Wanted{"transparent", "cache", 3,
                           [](RenderOptions& o) { o.transparent = true; }},
                    Wanted{"brute", "cache", 3, [](RenderOptions& o) { o.sharedBounces = false; }}),
    [](const auto& wanted) { return wanted.param.name; });

TEST(LightGroups, AddUpWhereEmissionRaysLookForWhatShines) {
    const test::World world(litRoom(), sky(), kBake);
    RenderStats stats;
    const Film film =
        Films(world.scene, &world.cache.cache(), world.environment, {"emission"}).film(1, stats);
    EXPECT_GT(stats.emissionRays, 0u);
    EXPECT_LT(misfitOf(film), kRoundings);
}

// Where a cache counts no lamps, what its rays met of them is predicted, by group as well.
TEST(LightGroups, AddUpWhereTheCacheCountsNoLamps) {
    TriangleMesh dark = litRoom();
    BakeOptions options = kBake;
    options.lamps = false;
    const test::World world(dark, sky(), options);
    const Film film = filmOf(world.scene, &world.cache.cache(), world.environment, {"uncounted"});
    EXPECT_LT(misfitOf(film), kRoundings);
    EXPECT_GT(meanOf(film, numberOf(film, "panel")), 0.01 * meanOf(film));
}

/// The room with one of its lights alone: "sky", or the name of what shines.
struct Alone {
    TriangleMesh mesh = litRoom();
    bool sky;

    explicit Alone(const std::string& name) : sky(name == "sky") {
        for (Lamp& lamp : mesh.lamps)
            if (lamp.name != name) lamp.gain = Rgb(0, 0, 0);
        for (Material& material : mesh.materials)
            if (material.name != name) material.finish.emission = Rgb(0, 0, 0);
    }
};

TEST(LightGroups, AreThePicturesOfTheirLightAlone) {
    constexpr std::uint64_t kSeeds = 24;
    const test::World world(litRoom(), sky(), kBake);
    const Environment night = test::environmentOf(test::constantMap(Rgb(0, 0, 0)));
    const std::vector<std::string> names{"sky", "bulb", "spot", "panel", "screen"};
    std::vector<std::vector<double>> ofGroups(names.size()), direct(names.size());
    for (const int bounces : {3, 0}) {
        Wanted wanted{"all"};
        wanted.bounces = bounces;
        const Films films(world.scene, &world.cache.cache(), world.environment, wanted);
        for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
            const Film film = films.film(seed);
            for (std::size_t g = 0; g < names.size(); ++g)
                (bounces == 0 ? direct : ofGroups)[g].push_back(
                    meanOf(film, numberOf(film, names[g])));
        }
    }
    double least = 1, most = 0;
    for (std::size_t g = 0; g < names.size(); ++g) {
        const Alone alone(names[g]);
        const Scene scene(alone.mesh);
        const Films films(scene, nullptr, alone.sky ? world.environment : night,
                          {"alone", "mis", 3, [](RenderOptions&) {}, {}});
        std::vector<double> truth;
        for (std::uint64_t seed = 1; seed <= kSeeds; ++seed)
            truth.push_back(meanOf(films.film(seed + 1000)));
        least = std::min(least, test::sameMeanPValue(ofGroups[g], truth));
        // Control: without the light that bounces.
        most = std::max(most, test::sameMeanPValue(direct[g], truth));
    }
    EXPECT_GT(static_cast<double>(names.size()) * least, test::significance(1));
    EXPECT_LT(most, test::significance(1));
}

TEST(LightGroups, AreMixedToThePictureOfOtherGains) {
    constexpr std::uint64_t kSeeds = 24;
    const test::World world(litRoom(), sky(), kBake);
    TriangleMesh other = litRoom();
    other.lamps[0].gain = Rgb(3, 1, 0.5f);
    other.materials[2].finish.gain = Rgb(0.2f, 0.2f, 0.2f);
    const Scene scene(other);
    const Films films(world.scene, &world.cache.cache(), world.environment, {"mixed"});
    const Films others(scene, &world.cache.cache(), world.environment,
                       {"other", "cache", 3, [](RenderOptions&) {}, {}});
    std::vector<double> mixed, wrong, truth;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        const Film film = films.film(seed);
        const auto mean = [&](const Rgb& bulb, float panel) {
            Rgb sum(0, 0, 0);
            for (std::size_t i = 0; i < film.pixels.size(); ++i)
                for (std::size_t g = 0; g < film.groups.size(); ++g) {
                    const Rgb gain = film.groups[g] == "bulb"    ? bulb
                                     : film.groups[g] == "panel" ? Rgb(panel)
                                                                 : Rgb(1.0f);
                    sum += film.groupColors[i][g] * gain;
                }
            return static_cast<double>(sum.dot(Rgb(1, 1, 1))) /
                   static_cast<double>(film.pixels.size());
        };
        mixed.push_back(mean(Rgb(3, 1, 0.5f), 0.2f));
        wrong.push_back(mean(Rgb(3, 1, 0.5f), 0.6f));
        truth.push_back(meanOf(others.film(seed + 1000)));
    }
    EXPECT_GT(test::sameMeanPValue(mixed, truth), test::significance(1));
    EXPECT_LT(test::sameMeanPValue(wrong, truth), test::significance(1));
}

// More lamps than emitters: some of different groups share a count.
TEST(LightGroups, AddUpWhereLampsShareAnEmitter) {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -2, 2, -2, 2);
    test::addFloor(mesh, 2, -2, 2, -2, 2);
    for (int i = 0; i < 50; ++i) {
        Lamp lamp;
        lamp.name = i % 2 == 0 ? "even" : "odd";
        lamp.strength = i % 2 == 0 ? Rgb(0.1f, 0, 0) : Rgb(0, 0.2f, 0.1f);
        lamp.position = {-1.5 + 0.06 * i, 1.5, 0.3 * std::sin(i)};
        mesh.lamps.push_back(lamp);
    }
    const test::World world(mesh, test::constantMap(Rgb(0, 0, 0)), kBake);
    const Film film = filmOf(world.scene, &world.cache.cache(), world.environment, {"many"});
    EXPECT_LT(misfitOf(film), kRoundings);
    EXPECT_EQ(meanOf(film, numberOf(film, "sky")), 0);
    // By their colours: in a grey room, light of one group has none of the other's.
    const std::size_t even = numberOf(film, "even"), odd = numberOf(film, "odd");
    for (std::size_t i = 0; i < film.pixels.size(); ++i) {
        EXPECT_EQ(film.groupColors[i][even].y, 0);
        EXPECT_EQ(film.groupColors[i][odd].x, 0);
    }
    EXPECT_GT(meanOf(film, even), 0);
}

// Rays of paths meet what moves and shines.
TEST(LightGroups, HaveTheLightOfWhatMoves) {
    const test::World world(litRoom(), sky(), kBake);
    TriangleMesh moving;
    moving.origin = world.mesh.origin;
    test::addBox(moving, {-0.5f, 1.2f, -0.4f}, {-0.1f, 1.6f, 0});
    Material glow = surface("glow", Rgb(0.1f));
    glow.finish.emission = Rgb(5, 5, 5);
    addPart(moving, glow);
    const Scene over(moving);
    Scene scene(world.mesh);
    scene.setMoving(&over);
    Wanted wanted{"moving"};
    wanted.groups = {{"screens", "screen"}, {"", "bulb"}};
    const Film film = filmOf(scene, &world.cache.cache(), world.environment, wanted);
    EXPECT_EQ(film.groups, (std::vector<std::string>{"sky", "screens", "bulb", "rest"}));
    EXPECT_LT(misfitOf(film), kRoundings);
    const double rest = meanOf(film, 3);
    moving.materials[0].name = "screen";
    const Film joined = filmOf(scene, &world.cache.cache(), world.environment, wanted);
    EXPECT_LT(misfitOf(joined), kRoundings);
    EXPECT_LT(meanOf(joined, 3), 0.9 * rest);
    EXPECT_GT(meanOf(joined, 1), meanOf(film, 1) + 0.05 * rest);
}

TEST(LightGroups, AreRefusedWhereTheyCannotBe) {
    TriangleMesh mesh = litRoom();
    const auto namesOf = [&](const std::vector<LightGroupRule>& rules) {
        return LightGroups(rules, mesh, nullptr).names();
    };
    EXPECT_EQ(
        namesOf({parseLightGroup("*"), parseLightGroup("ceiling=sp*")}),
        (std::vector<std::string>{"sky", "bulb", "spot", "panel", "screen", "ceiling", "rest"}));
    test::expectError([&] { namesOf({{"", "bulbs"}}); }, "--light-groups bulbs", "bulb?");
    test::expectError([] { parseLightGroup("sky=*"); }, "--light-groups sky", "with another one");
    test::expectError([] { parseLightGroup("rest=*"); }, "--light-groups rest", "with another one");
    for (const char* text : {"", "=", "=bulb", "a="})
        EXPECT_THROW(parseLightGroup(text), Error) << text;
    mesh.lamps[0].name = "sky";
    test::expectError([&] { namesOf({{"", "*"}}); }, "--light-groups sky", "GROUP=NAME");
    mesh.lamps[0].name = "a\nb";
    test::expectError([&] { namesOf({{"", "*"}}); }, "--light-groups", "control character");
    mesh.lamps[0].name = std::string(300, 'x');
    test::expectError([&] { namesOf({{"", "*"}}); }, "300 bytes", "at most 200");
    mesh.lamps[0].name = "emission";
    const Scene scene(mesh);
    LightingOptions lighting;
    lighting.groups = {{"", "*"}};
    test::expectError([&] { LitStage(scene, nullptr, findEstimator("mis"), lighting); },
                      "--light-groups emission", "AOV");
    for (int i = 0; i < 70; ++i) {
        mesh.lamps.push_back(mesh.lamps[1]);
        mesh.lamps.back().name = "lamp" + std::to_string(i);
    }
    test::expectError([&] { namesOf({{"", "lamp*"}}); }, "72 groups", "at most 64");
}

}  // namespace
}  // namespace shadowcache
