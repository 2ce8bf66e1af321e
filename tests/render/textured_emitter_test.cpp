// Triangles with a picture are lit from where that is bright: means by closed forms, densities that
// are those of the points, and next to no noise of the picture's.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "common/base/hash.h"
#include "common/emitters/emitters.h"
#include "tests/support/glossy_reference.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

constexpr int kTexels = 32;
/// Column and row of the texels that are lit.
constexpr std::array<std::array<int, 2>, 2> kLit{{{7, 20}, {26, 3}}};

/// A floor under a screen of 1 m, which has next to nothing lit.
TriangleMesh underScreen(double height, bool smooth) {
    TriangleMesh mesh;
    const auto y = static_cast<float>(height);
    test::addFloor(mesh, 0, -2, 2, -2, 2);
    test::addQuad(mesh, {0, y, 0}, {1, y, 0}, {1, y, 1}, {0, y, 1});
    for (const Vec3f& p : mesh.positions) mesh.texcoords.emplace_back(p.x, p.z, 1.0f);
    Texture picture;
    picture.width = picture.height = kTexels;
    picture.smooth = smooth;
    picture.rgba.resize(std::size_t{4} * kTexels * kTexels, 0);
    for (const auto& [column, row] : kLit)
        for (std::size_t k = 0; k < 4; ++k)
            picture.rgba[4 * static_cast<std::size_t>(row * kTexels + column) + k] = 255;
    mesh.textures = {picture};
    Material dark, screen;
    screen.finish.emission = Rgb(100, 200, 300);
    screen.finish.emissionTexture.texture = 0;
    screen.doubleSided = true;
    mesh.materials = {dark, screen};
    mesh.parts = {{0, 2, 0}, {2, 2, 1}};
    return mesh;
}

/// Irradiance by the lit texels, of a radiance of 1.
double irradianceOf(const ShadingPoint& point, double height) {
    double sum = 0;
    for (const std::array<int, 2>& texel : kLit) {
        const auto at = [&](int i, int j) {
            return Vec3d(static_cast<double>(texel[0] + i) / kTexels, height,
                         static_cast<double>(texel[1] + j) / kTexels);
        };
        const std::vector<Vec3d> corners{at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
        sum += test::polygonIrradiance(Vec3d(point.place.rayOrigin), Vec3d(point.place.normal),
                                       corners);
    }
    return std::abs(sum);
}

// With a control. Even points of the lit triangles would have a relative variance of 500.
TEST(TexturedEmitter, LightsFromWhereItsPictureIsBright) {
    double least = 1, leastOfControl = 1;
    int tests = 0;
    for (const double height : {0.2, 3.0}) {
        const test::World world(underScreen(height, false), test::constantMap(Rgb(0, 0, 0)));
        const ShadingPoint point = test::pointAlong(world.scene, {0.6f, 0.01f, 0.3f}, {0, -1, 0});
        const double truth = 200 * irradianceOf(point, height);
        for (const char* name : {"mis", "cache"}) {
            const auto estimator = findEstimator(name).make(world.context(), {});
            const test::Estimates found = test::runEstimator(*estimator, point, 4, 2000);
            ++tests;
            const auto with = [&](double factor) {
                const auto y = static_cast<float>(factor * truth);
                return test::agreementPValue(found, Rgb(y / 2, y, y * 1.5f));
            };
            least = std::min(least, with(1));
            leastOfControl = std::min(leastOfControl, with(1.25));
            EXPECT_LT(4 * found.sampleVariance(1), 8 * truth * truth) << height << " " << name;
        }
    }
    EXPECT_GT(tests * least, test::significance(4));
    EXPECT_LT(leastOfControl, test::significance(4));
}

TEST(TexturedEmitter, DrawsPointsWithTheDensityThatItTells) {
    const TriangleMesh mesh = underScreen(0.5, true);
    const std::array meshes{&mesh};
    const Emitters emitters(meshes);
    ASSERT_EQ(emitters.parts().size(), 2u);
    for (const EmitterPart& t : emitters.parts()) {
        ASSERT_NE(t.table, EmitterPart::kNoTable);
        for (const Receiver& at :
             {Receiver{{0.3f, 0, 0.4f}, {0, 1, 0}}, Receiver{{0.7f, 0.45f, 0.2f}, {0.6f, 0.8f, 0}},
              Receiver{{5, -3, 8}, {0, 1, 0}}}) {
            // What a radiance of 1 lights, by both ways to draw.
            constexpr std::uint64_t kPoints = 40000;
            const auto light = [&](const EmitterPoint& point) {
                return point.density > 0
                           ? static_cast<double>(std::max(0.0f, at.normal.dot(point.direction)) /
                                                 point.density)
                           : 0.0;
            };
            double sum = 0, square = 0, even = 0;
            for (std::uint64_t k = 0; k < kPoints; ++k) {
                const double u = toUnit(hashWords(k, 1)), v = toUnit(hashWords(k, 2));
                const EmitterPoint point = emitters.sample(t, at, u, v);
                even += light(samplePoint(t, at, u, v)) / kPoints;
                if (!(point.density > 0)) continue;
                EXPECT_NEAR(emitters.densityAt(t, at, point.position) / point.density, 1, 1e-3);
                // Where the point says that it is.
                const Vec3f there = t.corner[0] + (t.corner[1] - t.corner[0]) * point.u +
                                    (t.corner[2] - t.corner[0]) * point.v;
                EXPECT_LT((there - point.position).length(), 1e-5f);
                sum += light(point) / kPoints;
                square += light(point) * light(point) / kPoints;
            }
            const double deviation = std::sqrt((square - sum * sum) / kPoints);
            EXPECT_NEAR(sum, even, 5 * deviation + 0.01 * even);
            EXPECT_LT(deviation, 0.02 * even);
        }
    }
}

// Pictures that are about even have none.
TEST(TexturedEmitter, HasNoTableWhereItHelpsLittle) {
    TriangleMesh mesh = underScreen(1, true);
    std::uint64_t word = 1;
    for (std::uint8_t& channel : mesh.textures[0].rgba)
        channel = static_cast<std::uint8_t>(128 + (word = mixBits(word)) % 128);
    const std::array meshes{&mesh};
    for (const EmitterPart& t : Emitters(meshes).parts()) {
        EXPECT_EQ(t.table, EmitterPart::kNoTable);
        EXPECT_TRUE(t.varies);
    }
}

}  // namespace
}  // namespace shadowcache
