// Ten million triangles, and a map of 16384 x 8192 texels.

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "common/base/parallel.h"
#include "common/image/exr.h"
#include "common/image/radiance.h"
#include "common/import/load_mesh.h"
#include "render/frame/integrator.h"
#include "render/table/estimator_table.h"
#include "scenes/sets.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

/// Memory of the machine, in bytes.
double physicalMemory() {
    return static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
           static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// Means over the pictures of `count` seeds.
std::vector<double> pictureMeans(const EstimatorContext& context, const std::string& name,
                                 const Camera& camera, int count) {
    RenderOptions options;
    options.width = 48;
    options.height = 27;
    options.samples = 16;
    const auto estimator = findEstimator(name).make(context);
    std::vector<double> means;
    for (int i = 1; i <= count; ++i) {
        options.seed = static_cast<std::uint64_t>(i);
        RenderStats stats;
        const Film film = render({*estimator, camera, 1, options}, stats);
        double sum = 0;
        for (const Pixel& pixel : film.pixels) sum += static_cast<double>(pixel.irradiance.y);
        means.push_back(sum / static_cast<double>(film.pixels.size()));
    }
    return means;
}

TEST(TenMillionTriangles, AreBakedAndRenderedWithoutBias) {
    if (physicalMemory() < 8e9) GTEST_SKIP() << "needs 8 GB of memory";
    constexpr std::int64_t kTriangles = 10'000'000;
    const test::TemporaryFolder folder;
    const std::filesystem::path path = folder.path() / "scatter.ply";
    scenes::writeScatter(path, kTriangles);
    const TriangleMesh mesh = loadMesh({&path, 1}, {});
    std::filesystem::remove(path);
    EXPECT_EQ(mesh.report.facesRead, static_cast<std::size_t>(kTriangles));
    EXPECT_EQ(mesh.report.triangles + mesh.report.degenerate, static_cast<std::size_t>(kTriangles));
    EXPECT_EQ(mesh.triangles.size(), mesh.report.triangles);

    const Scene scene(mesh);
    BakeOptions options;
    options.spacing = 1.0;
    options.level = 3;
    options.rays = 8;
    const BakeResult baked = bake(scene, options);
    EXPECT_GT(baked.items.size(), 5000u);
    const test::TestCache cache(baked);
    const Environment environment = test::environmentOf(test::noiseMap(64, 32, 6));
    const EstimatorContext context{scene, environment, &cache.cache(), {}};
    const scenes::CameraKey key = scenes::scatterWalk(kTriangles)[0];
    const Camera camera = lookAt(key.position, key.target, {0, 1, 0}, 0.9);
    const auto truth = pictureMeans(context, "mis", camera, 40);
    auto cached = pictureMeans(context, "cache", camera, 40);
    EXPECT_GT(test::sameMeanPValue(truth, cached), test::significance(1));
    // Control: 3 % more is seen.
    for (double& mean : cached) mean *= 1.03;
    EXPECT_LT(test::sameMeanPValue(truth, cached), test::significance(1));
}

constexpr int kWidth = 16384, kHeight = 8192;
constexpr int kBlock = 1024;  ///< side of the squares that samples are counted in
constexpr int kColumns = kWidth / kBlock, kRows = kHeight / kBlock;

/// A sky, darker ground with stripes finer than any cell, and a sun of three by three texels.
float radianceAt(int x, int y) {
    if (std::abs(x - 5000) <= 1 && std::abs(y - 2500) <= 1) return 60000.0f;
    const float stripe = (x / 3 + y / 5) % 2 ? 1.0f : 0.25f;
    return y < kHeight / 2 ? 1.0f + stripe * static_cast<float>(y) / kHeight : 0.2f * stripe;
}

std::filesystem::path writeMap(const test::TemporaryFolder& folder) {
    Channel luminance{"Y", std::vector<float>(std::size_t{kWidth} * kHeight)};
    parallelFor(kHeight, 16, [&](const Chunk& rows) {
        for (std::size_t y = rows.begin; y < rows.end; ++y)
            for (std::size_t x = 0; x < kWidth; ++x)
                luminance.values[y * kWidth + x] =
                    radianceAt(static_cast<int>(x), static_cast<int>(y));
    });
    writeExr(folder.path() / "map.exr", kWidth, kHeight, {luminance}, {}, PixelType::half);
    return folder.path() / "map.exr";
}

/// Luminance times solid angle in each square of the map.
std::vector<double> luminanceBySquare(const Image& map) {
    std::vector<double> luminance(kColumns * kRows);
    for (int y = 0; y < kHeight; ++y) {
        const double solidAngle =
            2 * kPi / kWidth * (std::cos(kPi * y / kHeight) - std::cos(kPi * (y + 1) / kHeight));
        for (int x = 0; x < kWidth; ++x)
            luminance[static_cast<std::size_t>(y / kBlock * kColumns + x / kBlock)] +=
                solidAngle *
                static_cast<double>(
                    map.pixels[static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x)]
                        .y);
    }
    return luminance;
}

/// Chi-squared of how often samples land in each square, u bent by `bend`.
template <class Bend>
double histogramPValue(const Environment& environment, const std::vector<double>& luminance,
                       const Bend& bend) {
    constexpr int kSamples = 4'000'000;
    std::vector<double> observed(luminance.size()), expected(luminance);
    double total = 0;
    for (const double p : luminance) total += p;
    for (double& e : expected) e *= kSamples / total;
    std::mt19937_64 generator(7);
    std::uniform_real_distribution<double> uniform;
    for (int i = 0; i < kSamples; ++i) {
        const EnvironmentSample s = environment.sample(bend(uniform(generator)), 0.5f, 0.5f);
        const auto [x, y] = test::texelAt(kWidth, kHeight, Vec3d(s.direction));
        ++observed[static_cast<std::size_t>(y / kBlock * kColumns + x / kBlock)];
    }
    return test::chiSquaredPValue(observed, expected);
}

TEST(MapOf16kBy8k, IsSampledByItsLight) {
    if (physicalMemory() < 12e9) GTEST_SKIP() << "needs 12 GB of memory";
    const test::TemporaryFolder folder;
    RadianceImage loaded = readRadiance(writeMap(folder));
    ASSERT_EQ(loaded.image.width, kWidth);
    ASSERT_EQ(loaded.image.height, kHeight);
    EXPECT_EQ(loaded.negative + loaded.notANumber, 0u);
    const std::vector<double> luminance = luminanceBySquare(loaded.image);
    double total = 0;
    for (const double p : luminance) total += p;
    const Environment environment = test::environmentOf(loaded.image);
    loaded.image = {};
    EXPECT_NEAR(environment.luminanceIntegral() / total, 1, 1e-6);
    EXPECT_EQ(environment.texelCount(), std::size_t{kWidth} * kHeight);

    const double density = parallelSum(environment.texelCount(), 1 << 16, [&](const Chunk& chunk) {
        double sum = 0;
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const Environment::Texel texel = environment.texel(i);
            sum += static_cast<double>(texel.solidAngle) *
                   static_cast<double>(environment.lookUp(texel.center).density);
        }
        return sum;
    });
    EXPECT_NEAR(density, 1, 1e-5);

    EXPECT_GT(histogramPValue(environment, luminance, [](double u) { return u; }),
              test::significance(1));
    // Control: a 3 % tilt is seen.
    EXPECT_LT(
        histogramPValue(environment, luminance, [](double u) { return u * (0.97 + 0.03 * u); }),
        test::significance(1));
}

}  // namespace
}  // namespace shadowcache
