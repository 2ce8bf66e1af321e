// Lamps that an animation moves: pictures of a frame are those of the set as it stands in it, in
// light groups, too; a cache changes no mean, and knows the lamps that stand still.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/cache/cache_items.h"
#include "render/library/lit_stage.h"
#include "render/library/stage.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

using Json = nlohmann::json;

/// A file with a lamp that moves over a square of 1 m in frames 0 to 24, and perhaps one that does
/// not.
test::GltfBuilder withLamp(test::GltfBuilder file, bool withStill) {
    file.json["extensionsUsed"] = {"KHR_lights_punctual"};
    Json& lights = file.json["extensions"]["KHR_lights_punctual"]["lights"];
    lights = {{{"type", "point"}, {"intensity", 2}, {"extras", {{"radius", 0.1}}}}};
    Json node{{"name", "moving"}};
    node["extensions"]["KHR_lights_punctual"]["light"] = 0;
    file.animate(file.root(node), "translation", "LINEAR", {0, 1}, {0, 0, 0.5f, 1, 1, 0.5f});
    if (!withStill) return file;
    node["name"] = "still";
    node["translation"] = {0.5, 0.2, 0.4};
    file.root(node);
    return file;
}

test::GltfBuilder lampOverSquare(bool withStill) {
    return withLamp(test::squareScene(), withStill);
}

/// Pictures of a file's frames.
class Shot {
public:
    Shot(const std::filesystem::path& file, std::optional<int> still,
         const std::filesystem::path& cache = {}, int bounces = 0,
         const std::vector<DynamicFile>& dynamic = {})
        : stage_(optionsOf(file, still, cache, dynamic), [](const std::string&, NoteKind) {}),
          environment_(test::environmentOf(test::constantMap(Rgb(0.0f)))) {
        stage_.load();
        LightingOptions lighting;
        lighting.bounces = options_.bounces = bounces;
        lighting.groups = {{"", "*"}};
        lit_.emplace(stage_.scene(), stage_.cache(), findEstimator(cache.empty() ? "mis" : "cache"),
                     lighting);
        lit_->setEnvironment(environment_);
        options_.width = options_.height = 8;
        options_.cameraRays = 1;
        options_.samples = 4;
    }

    Film film(int frame, std::uint64_t seed = 1) {
        if (stage_.pose(frame)) lit_->moveLamps();
        options_.seed = seed;
        RenderStats stats;
        const Camera camera = lookAt({0.5, 0.5, 1.5}, {0.5, 0.5, 0}, {0, 1, 0}, 0.6);
        return lit_->plan(camera, frame, options_, stats).film(stats);
    }

    /// Mean radiance of pictures by some seeds.
    std::vector<double> means(int frame) {
        std::vector<double> means;
        for (std::uint64_t seed = 1; seed <= 40; ++seed) {
            double& mean = means.emplace_back(0);
            for (const Pixel& pixel : film(frame, seed).pixels)
                mean += static_cast<double>(pixel.color.y) / 64;
        }
        return means;
    }

    Stage& stage() { return stage_; }
    const LitStage& lit() const { return *lit_; }

private:
    static StageOptions optionsOf(const std::filesystem::path& file, std::optional<int> still,
                                  const std::filesystem::path& cache,
                                  const std::vector<DynamicFile>& dynamic) {
        StageOptions options;
        options.set.dynamic = dynamic;
        options.set.files = {file};
        options.set.frame = still;
        options.cache = cache;
        return options;
    }

    Stage stage_;
    const Environment environment_;
    RenderOptions options_;
    std::optional<LitStage> lit_;
};

bool areSame(const Film& a, const Film& b) {
    return std::ranges::equal(a.pixels, b.pixels, [](const Pixel& one, const Pixel& other) {
        return one.color == other.color;
    });
}

// With its control: frames differ.
TEST(MovingLamp, IsInEachFrameWhereItIs) {
    const test::TemporaryFolder folder;
    const auto file = folder.write("a.glb", lampOverSquare(false).glb());
    Shot shot(file, {});
    for (const int frame : {3, 20, 3}) {
        const Film film = shot.film(frame);
        EXPECT_GT(film.pixels[27].color.y, 0);
        ASSERT_EQ(film.groups, (std::vector<std::string>{"sky", "moving", "rest"}));
        EXPECT_EQ(film.groupColors[27][1], film.pixels[27].color);
        EXPECT_TRUE(areSame(film, Shot(file, frame).film(frame))) << frame;
        EXPECT_FALSE(areSame(film, Shot(file, 12).film(frame))) << frame;
    }
    const LampGain off[] = {parseLampGain("moving=0")};
    shot.stage().setGains(off);
    EXPECT_TRUE(shot.stage().pose(12));
    EXPECT_EQ(shot.stage().mesh().lamps.back().gain, Rgb(0, 0, 0));
    EXPECT_FALSE(shot.stage().pose(12));
}

class MovingLampWithCache : public testing::Test {
protected:
    MovingLampWithCache() {
        Stage stage({.set = {.files = {file_}}}, [](const std::string&, NoteKind) {});
        stage.load();
        BakeOptions options;
        options.spacing = 0.25;
        const BakeResult baked = bake(stage.scene(), options);
        writeCache(cache_, baked.header, baked.items);
    }

    const test::TemporaryFolder folder_;
    const std::filesystem::path file_ = folder_.write("a.glb", lampOverSquare(true).glb());
    const std::filesystem::path cache_ = folder_.path() / "a.vdb";
};

// Without and with a lamp of another file, on a track.
TEST_F(MovingLampWithCache, HasItsMean) {
    const auto other = folder_.write("b.glb", withLamp({}, false).glb());
    std::string track = "[{}";
    for (int frame = 2; frame <= 20; ++frame) track += R"(, {"translation": [0.5, 0, 0]})";
    const DynamicFile onTrack{other, folder_.write("t.json", R"({"frames": )" + track + "]}")};
    double least = 1, leastOfControl = 1;
    for (const auto& dynamic : {std::vector<DynamicFile>(), std::vector{onTrack}}) {
        const int bounces = dynamic.empty() ? 0 : 1;
        Shot with(file_, {}, cache_, bounces, dynamic);
        for (const int frame : {4, 20}) {
            const std::vector<double> found = with.means(frame);
            const std::vector<double> wanted =
                Shot(file_, frame, {}, bounces, dynamic).means(frame);
            least = std::min(least, test::sameMeanPValue(found, wanted));
            std::vector<double> brighter = found;
            for (double& mean : brighter) mean *= 1.05;
            leastOfControl = std::min(leastOfControl, test::sameMeanPValue(brighter, wanted));
        }
    }
    EXPECT_GT(4 * least, test::significance(2));
    EXPECT_LT(leastOfControl, test::significance(2));
}

TEST_F(MovingLampWithCache, LeavesTheOthersTheirCounts) {
    const ShadowCache cache(cache_);
    EXPECT_EQ(cache.header().emitters.size(), 1u);
    Shot shot(file_, {}, cache_);
    EXPECT_EQ(shot.lit().note(), "");
    const Scene& scene = shot.stage().scene();
    const auto light = SetLight::of(scene, &cache);
    ASSERT_EQ(light->emitters().size(), 2u);
    EXPECT_TRUE(light->knowsAll());
    EXPECT_TRUE(light->moves());
    const ItemTable items(cache);
    const std::vector<Rgb> before = light->predictItems(items);
    ASSERT_FALSE(before.empty());
    EXPECT_TRUE(shot.stage().pose(20));
    light->moveLamps();
    EXPECT_EQ(light->predictItems(items), before);
    RenderOptions preview;
    preview.samples = 0;
    test::expectError([&] { shot.lit().requirePrediction(preview); }, "lamps that move",
                      "--set-frame");
}

}  // namespace
}  // namespace shadowcache
