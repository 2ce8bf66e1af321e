// The path that the programs take by default, against known truths: a pilot pass, samples shared
// out by its budget, several camera rays a pixel, neighbours that share mispredicted samples.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "common/base/sequence.h"
#include "render/frame/integrator.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

constexpr int kWidth = 18, kHeight = 12;
constexpr int kStrips = 3;  ///< of the film, side by side, each compared with a truth of its own

const Rgb kSky(1, 0.5f, 2);
constexpr float kLampRadiance = 40;  ///< in units of the sky's
const Vec3d kSeenLamp(-1, 0.7, 0.1), kHiddenLamp(1.25, 1, 0);

/// A constant sky with one bright texel that all of the film's floor sees and one that the slab
/// hides from all of it.
struct Light {
    static constexpr int kMapWidth = 64, kMapHeight = 32;
    std::array<int, 2> seen = texelOf(kSeenLamp), hidden = texelOf(kHiddenLamp);
    Image map = makeMap();

    static std::array<int, 2> texelOf(const Vec3d& direction) {
        return test::texelAt(kMapWidth, kMapHeight, direction.normalized());
    }
    Image makeMap() const {
        Image image{kMapWidth, kMapHeight, {}};
        image.pixels.assign(static_cast<std::size_t>(kMapWidth * kMapHeight), kSky);
        for (const auto& [x, y] : {seen, hidden})
            image.pixels[static_cast<std::size_t>(y * kMapWidth + x)] = kSky * kLampRadiance;
        return image;
    }
};

/// Looks straight down at the floor, from below the slab: the film maps to the floor linearly.
struct View {
    static constexpr double kFloorHeight = 0.6, kFloorWidth = kFloorHeight * kWidth / kHeight;

    static Camera camera() { return {{0, 0.25, 0}, {0, -1, 0}, {0, 0, -1}, 1, kFloorHeight}; }
    static ShadingPoint place(double filmX, double filmY) {
        const Vec3d p((filmX - 0.5) * kFloorWidth, 0, (filmY - 0.5) * kFloorHeight);
        return {Vec3f(p), p, {0, 1, 0}, 0};
    }
};

/// What a cache says that is not what the bake found.
struct CacheKind {
    std::string name;
    std::function<void(BakeResult&)> change;
};

void fillCounts(BakeResult& baked, const std::function<std::array<int, 2>(std::size_t)>& counts) {
    for (std::size_t i = 0; i < baked.items.n.size(); ++i) {
        const auto [n, d] = counts(i);
        baked.items.n[i] = static_cast<std::uint8_t>(n);
        baked.items.d[i] = static_cast<std::uint8_t>(d);
    }
    baked.items.blocks.clear();
    std::ranges::fill(baked.items.firstBlock, 0u);
}

/// The base cell of `direction` is called `n` of 200 by every item; the rest stays as baked.
void tellOneCell(BakeResult& baked, const Vec3d& direction, int n) {
    const DirectionTiers tiers = baked.header.tiers();
    const std::uint32_t cell = locateCell(tiers.baseLevel(), direction.normalized());
    const CacheItems honest = baked.items;
    baked.items.blocks.clear();
    baked.items.firstBlock = {0};
    for (std::size_t i = 0; i < honest.size(); ++i) {
        baked.items.n[i * tiers.baseCells() + cell] = static_cast<std::uint8_t>(n);
        baked.items.d[i * tiers.baseCells() + cell] = 200;
        for (std::uint32_t b = honest.firstBlock[i]; b < honest.firstBlock[i + 1]; ++b) {
            const std::uint32_t key = honest.blocks[b].key;
            const bool first = key < tiers.blockKey(1, 0);
            const std::uint32_t parent = first ? key : (key - tiers.blockKey(1, 0)) / kBlockCells;
            if (parent != cell) baked.items.blocks.push_back(honest.blocks[b]);
        }
        baked.items.firstBlock.push_back(static_cast<std::uint32_t>(baked.items.blocks.size()));
    }
}

std::vector<CacheKind> cacheKinds() {
    return {{"Honest", [](BakeResult&) {}},
            {"AllDark",
             [](BakeResult& b) { fillCounts(b, [](std::size_t) {
                                     return std::array{0, 255};
                                 }); }},
            {"AllOpen",
             [](BakeResult& b) {
                 fillCounts(b, [](std::size_t) { return std::array{255, 255}; });
             }},
            {"Random",
             [](BakeResult& b) {
                 fillCounts(b, [](std::size_t i) {
                     const std::uint64_t h = hashWords(91, i);
                     const int d = static_cast<int>(h % 256);
                     return std::array{
                         static_cast<int>((h >> 20) % static_cast<std::uint64_t>(d + 1)), d};
                 });
             }},
            {"LampCalledHidden", [](BakeResult& b) { tellOneCell(b, kSeenLamp, 0); }},
            {"LampCalledSeen", [](BakeResult& b) { tellOneCell(b, kHiddenLamp, 200); }}};
}

/// The floor under a slab, the light and a cache of one kind.
struct LitFloor {
    Light light;
    TriangleMesh mesh = test::slabMesh();
    Scene scene{mesh};
    Environment environment = test::environmentOf(light.map);
    test::TestCache cache;

    explicit LitFloor(const CacheKind& kind) : cache(baked(kind)) {}

    EstimatorContext context() const { return {scene, environment, &cache.cache()}; }

    /// Mean irradiance of a strip of the film, from `nodes` x `nodes` places in each pixel.
    Rgb truth(int strip, int nodes) const {
        const double lamp =
            (static_cast<double>(kLampRadiance) - 1) *
            test::texelMoment(Light::kMapWidth, Light::kMapHeight, light.seen[0], light.seen[1]).y;
        double sum = 0;
        const int columns = kWidth / kStrips * nodes, rows = kHeight * nodes;
        for (int i = 0; i < columns; ++i)
            for (int j = 0; j < rows; ++j)
                sum += kPi + lamp -
                       test::hiddenByConvex(
                           mesh, 2, mesh.triangles.size(),
                           View::place((strip + (i + 0.5) / columns) / kStrips, (j + 0.5) / rows));
        return kSky * static_cast<float>(sum / (columns * rows));
    }

private:
    BakeResult baked(const CacheKind& kind) const {
        BakeOptions options;
        options.spacing = 0.5;
        BakeResult result = bake(scene, options);
        kind.change(result);
        return result;
    }
};

RenderOptions effort(int cameraRays, int samples) {
    RenderOptions options;
    options.width = kWidth;
    options.height = kHeight;
    options.cameraRays = cameraRays;
    options.samples = samples;
    return options;
}

/// Films of seeds of their own after one pilot.
std::vector<Film> films(Estimator& estimator, RenderOptions options, int count) {
    RenderStats stats;
    options.seed = 1000;
    runPilot({estimator, View::camera(), 1, options}, stats);
    std::vector<Film> all;
    for (options.seed = 1; static_cast<int>(all.size()) < count; ++options.seed)
        all.push_back(render({estimator, View::camera(), 1, options}, stats));
    return all;
}

/// The mean irradiance of a strip in each film.
test::Estimates meansOf(const std::vector<Film>& films, int strip) {
    test::Estimates means;
    for (const Film& film : films) {
        Vec3d sum(0.0);
        for (int y = 0; y < kHeight; ++y)
            for (int x = strip * kWidth / kStrips; x < (strip + 1) * kWidth / kStrips; ++x)
                sum += Vec3d(film.pixels[static_cast<std::size_t>(y * kWidth + x)].irradiance);
        sum /= kHeight * kWidth / kStrips;
        for (int c = 0; c < 3; ++c) means.color[static_cast<std::size_t>(c)].push_back(sum[c]);
    }
    return means;
}

struct Effort {
    int cameraRays, samples;
};
constexpr Effort kEfforts[] = {{1, 1}, {1, 4},  {1, 16}, {1, 64}, {4, 1},
                               {4, 4}, {4, 16}, {16, 1}, {16, 4}, {16, 16}};

TEST(DefaultPathScene, IsWhatItsTruthTakesItFor) {
    const LitFloor floor(cacheKinds().front());
    for (const double x : {0.0, 0.5, 1.0})
        for (const double y : {0.0, 1.0}) {
            ShadingPoint point = View::place(x, y);
            point.rayOrigin.y = 1e-5f;
            const auto lit = [&](const std::array<int, 2>& texel) {
                return test::tracedTexelIrradiance(floor.scene, point, Light::kMapWidth,
                                                   Light::kMapHeight, texel[0], texel[1], 40);
            };
            const auto& [column, row] = floor.light.seen;
            EXPECT_NEAR(lit(floor.light.seen) /
                            test::texelMoment(Light::kMapWidth, Light::kMapHeight, column, row).y,
                        1, 1e-3);
            EXPECT_EQ(lit(floor.light.hidden), 0.0);
        }
    // The film shows the floor that View::place() says.
    const auto estimator = findEstimator("mis").make(floor.context());
    RenderStats stats;
    const Film film = render({*estimator, View::camera(), 1, effort(1, 1)}, stats);
    for (int y = 0; y < kHeight; y += kHeight - 1)
        for (int x = 0; x < kWidth; x += kWidth - 1) {
            const Pixel& pixel = film.pixels[static_cast<std::size_t>(y * kWidth + x)];
            const Vec3d wanted = View::place((x + 0.5) / kWidth, (y + 0.5) / kHeight).position;
            EXPECT_LT((Vec3d(pixel.position) - wanted).length(), 1e-5);
        }
}

struct Path {
    std::string name, estimator;
    CacheKind cache;
    int films;  ///< averaged over at 1 x 1
};

std::vector<Path> paths() {
    std::vector<Path> all{{"Mis", "mis", cacheKinds().front(), 1600}};
    for (const CacheKind& kind : cacheKinds()) all.push_back({kind.name, "cache", kind, 600});
    return all;
}

class DefaultPath : public testing::TestWithParam<std::size_t> {};

INSTANTIATE_TEST_SUITE_P(Caches, DefaultPath, testing::Range<std::size_t>(0, paths().size()),
                         [](const auto& test) { return paths()[test.param].name; });

// With its control: 4 % more is rejected.
TEST_P(DefaultPath, MeetsTheClosedForm) {
    const Path path = paths()[GetParam()];
    const LitFloor floor(path.cache);
    const auto estimator = findEstimator(path.estimator).make(floor.context());
    const double level = test::significance(kStrips * std::size(kEfforts));
    for (const auto& [cameraRays, samples] : kEfforts) {
        SCOPED_TRACE(std::to_string(cameraRays) + " x " + std::to_string(samples));
        const int count = std::max(36, path.films / (cameraRays * samples));
        const std::vector<Film> all = films(*estimator, effort(cameraRays, samples), count);
        for (int strip = 0; strip < kStrips; ++strip) {
            const test::Estimates means = meansOf(all, strip);
            const Rgb truth = floor.truth(strip, cameraRays == 1 ? 1 : 3);
            const double error = std::sqrt(means.sampleVariance(1) / count);
            EXPECT_GT(test::agreementPValue(means, truth), level)
                << "strip " << strip << ": mean " << means.mean(1) << ", standard error " << error
                << ", wanted " << truth.y;
            EXPECT_LT(test::agreementPValue(means, truth * 1.04f), level)
                << "strip " << strip << ", standard error " << error;
        }
    }
}

/// Variance of a pixel's irradiance over films, averaged over the pixels.
double pixelVariance(const std::vector<Film>& films) {
    double sum = 0;
    for (std::size_t p = 0; p < films.front().pixels.size(); ++p) {
        double mean = 0, squares = 0;
        for (const Film& film : films) mean += static_cast<double>(film.pixels[p].irradiance.y);
        mean /= static_cast<double>(films.size());
        for (const Film& film : films)
            squares += std::pow(static_cast<double>(film.pixels[p].irradiance.y) - mean, 2);
        sum += squares / static_cast<double>(films.size() - 1);
    }
    return sum / static_cast<double>(films.front().pixels.size());
}

/// How much of the variance may be left by four times the camera rays, and by sixteen times the
/// samples.
struct Falls {
    double withCameraRays, withSamples;
};

/// All but the slowest two.
class DefaultPathNoise : public DefaultPath {};

INSTANTIATE_TEST_SUITE_P(Caches, DefaultPathNoise, testing::Values<std::size_t>(0, 1, 2, 5, 6),
                         [](const auto& test) { return paths()[test.param].name; });

// Control: the same light samples for all camera rays of a pixel would leave all of the variance,
// as a pixel of one camera ray has it.
TEST_P(DefaultPathNoise, FallsWithCameraRaysAndWithSamples) {
    const Path path = paths()[GetParam()];
    const LitFloor floor(path.cache);
    const auto estimator = findEstimator(path.estimator).make(floor.context());
    const Falls most = path.estimator == "mis" ? Falls{0.3, 0.1} : Falls{0.35, 0.2};
    constexpr int kSteps = 3;  // 1, 4, 16
    double variance[kSteps][kSteps];
    for (int k = 0; k < kSteps; ++k)
        for (int n = 0; n < kSteps; ++n)
            variance[k][n] = pixelVariance(films(*estimator, effort(1 << 2 * k, 1 << 2 * n),
                                                 path.films / (path.estimator == "mis" ? 16 : 10)));
    for (int k = 0; k < kSteps; ++k) {
        SCOPED_TRACE(std::to_string(1 << 2 * k) + " camera rays");
        EXPECT_LT(variance[k][kSteps - 1], most.withSamples * variance[k][0]);
        for (int n = 0; n < kSteps && k > 0; ++n)
            EXPECT_LT(variance[k][n], most.withCameraRays * variance[k - 1][n])
                << (1 << 2 * n) << " samples";
    }
}

// Samples are shared out between the pixels; their mean stays what was asked for. A direction below
// the horizon takes no ray. Control: twice the samples are out of the range.
TEST_P(DefaultPath, TracesTheRaysAskedFor) {
    const Path path = paths()[GetParam()];
    const LitFloor floor(path.cache);
    const auto estimator = findEstimator(path.estimator).make(floor.context());
    const auto raysOf = [&](int cameraRays, int samples) {
        double rays = 0;
        const std::vector<Film> all = films(*estimator, effort(cameraRays, samples), 4);
        for (const Film& film : all)
            for (const Pixel& pixel : film.pixels)
                rays += static_cast<double>(pixel.rays - pixel.reusedRays);
        return rays / (kWidth * kHeight * static_cast<double>(all.size()));
    };
    for (const auto& [cameraRays, samples] : {Effort{1, 4}, {16, 1}, {4, 4}, {1, 64}}) {
        SCOPED_TRACE(std::to_string(cameraRays) + " x " + std::to_string(samples));
        const double wanted = cameraRays * samples, rays = raysOf(cameraRays, samples);
        EXPECT_GT(rays, 0.7 * wanted);
        EXPECT_LT(rays, 1.15 * wanted);
        EXPECT_GT(raysOf(cameraRays, 2 * samples), 1.15 * wanted);
    }
}

// The error that a film tells of itself, `variance`, against that of repeated films. Told from the
// spread of camera rays, it knows nothing of how they share the strata of a cluster: about twice
// too much.
TEST(DefaultPathFilm, TellsItsVariance) {
    const LitFloor floor(cacheKinds().front());
    const auto estimator = findEstimator("cache").make(floor.context());
    const std::vector<Film> all = films(*estimator, effort(16, 4), 60);
    double told = 0;
    for (const Film& film : all)
        for (const Pixel& pixel : film.pixels) told += static_cast<double>(pixel.variance);
    told /= kWidth * kHeight * static_cast<double>(all.size());
    const double measured = pixelVariance(all);
    EXPECT_GT(told, measured);
    EXPECT_LT(told, 2.6 * measured);
    EXPECT_GT(2 * told, 2.6 * measured) << "control";
    EXPECT_LT(told / 3, measured) << "control";
}

// Without samples the film is what the cache predicts. Control: what an empty cache predicts.
TEST(DefaultPathFilm, WithoutSamplesIsNearTheTruth) {
    const auto worst = [](const CacheKind& kind) {
        const LitFloor floor(kind);
        const auto estimator = findEstimator("cache").make(floor.context());
        const std::vector<Film> film = films(*estimator, effort(1, 0), 1);
        double most = 0;
        for (int strip = 0; strip < kStrips; ++strip) {
            const double truth = static_cast<double>(floor.truth(strip, 1).y);
            most = std::max(most, std::abs(meansOf(film, strip).mean(1) / truth - 1));
        }
        return most;
    };
    EXPECT_LT(worst(cacheKinds()[0]), 0.01);
    EXPECT_GT(worst(cacheKinds()[1]), 0.5);
}

// Frames have noise of their own: their errors are not those of the frame before.
TEST(DefaultPathFilm, FramesAreIndependent) {
    const LitFloor floor(cacheKinds().front());
    const auto estimator = findEstimator("cache").make(floor.context());
    RenderStats stats;
    std::vector<Film> frames;
    for (int number = 1; number <= 24; ++number)
        frames.push_back(render({*estimator, View::camera(), number, effort(1, 4)}, stats));
    const auto value = [&](std::size_t frame, std::size_t pixel) {
        return static_cast<double>(frames[frame].pixels[pixel].irradiance.y);
    };
    double same = 0, next = 0;
    for (std::size_t p = 0; p < frames[0].pixels.size(); ++p) {
        double mean = 0;
        for (std::size_t f = 0; f < frames.size(); ++f)
            mean += value(f, p) / static_cast<double>(frames.size());
        for (std::size_t f = 0; f + 1 < frames.size(); ++f) {
            same += std::pow(value(f, p) - mean, 2);
            next += (value(f, p) - mean) * (value(f + 1, p) - mean);
        }
    }
    EXPECT_GT(same, 0.0);
    EXPECT_LT(std::abs(next), 0.2 * same);
}

/// A ball alone under a gradient: nothing hides the sky, so the irradiance is linear in the normal.
class DefaultPathOnABall : public testing::TestWithParam<bool> {};

INSTANTIATE_TEST_SUITE_P(Caches, DefaultPathOnABall, testing::Bool(), [](const auto& test) {
    return std::string(test.param ? "AllDark" : "Honest");
});

// Points that are lit together have normals of their own. With its control: 1 % more is rejected.
TEST_P(DefaultPathOnABall, MeetsTheClosedForm) {
    const Vec3d slope(0.5, 0.3, -0.4);
    TriangleMesh mesh;
    test::addSphere(mesh, {0, 0, 0}, 1, 24);
    const test::World world(std::move(mesh), test::gradientMap(512, 256, slope));
    BakeResult told = world.baked;
    if (GetParam()) cacheKinds()[1].change(told);
    const test::TestCache cache(told);
    EstimatorContext context = world.context();
    context.cache = &cache.cache();
    const auto estimator = findEstimator("cache").make(context);
    const Camera camera = lookAt({2, 1.5, 1}, {0, 0, 0}, {0, 1, 0}, 0.5);
    const double level = test::significance(5);
    for (const auto& [cameraRays, samples] : {Effort{1, 1}, {1, 16}, {4, 4}, {16, 1}, {16, 4}}) {
        SCOPED_TRACE(std::to_string(cameraRays) + " x " + std::to_string(samples));
        RenderOptions options = effort(cameraRays, samples);
        RenderStats stats;
        options.seed = 1000;
        runPilot({*estimator, camera, 1, options}, stats);
        std::vector<double> ratios, more;
        for (options.seed = 1; options.seed <= 60; ++options.seed) {
            double found = 0, truth = 0;
            for (const Pixel& pixel : render({*estimator, camera, 1, options}, stats).pixels) {
                const double seen = static_cast<double>(pixel.albedo.y / options.albedo.y);
                found += static_cast<double>(pixel.irradiance.y);
                truth += kPi * seen + 2 * kPi / 3 * slope.dot(Vec3d(pixel.normal));
            }
            ratios.push_back(found / truth - 1);
            more.push_back(found / truth - 1.01);
        }
        EXPECT_GT(test::meanPValue(ratios, 0), level);
        EXPECT_LT(test::meanPValue(more, 0), level);
    }
}

}  // namespace
}  // namespace shadowcache
