// Maps turned about all axes and mirrored: radiance, moments, densities and samples are those of
// the turned texels, a sun keeps its integral; gain is linear, a tint is followed; a map turned
// by 1 and 5 degrees more is rejected.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "common/light/environment.h"
#include "common/random/sequence.h"
#include "tests/support/environment_maps.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

/// Of the cells that count as tiles of the sphere, about 7 degrees wide.
constexpr int kTileLevel = 3;

std::shared_ptr<const EnvironmentMap> mapOf(const Image& image) {
    return std::make_shared<const EnvironmentMap>(image, Rgb(0.2126f, 0.7152f, 0.0722f));
}

Turn mirrored(Turn turn) {
    turn.axis[0] = -turn.axis[0];
    return turn;
}

struct NamedTurn {
    std::string name;
    Turn turn;
};

std::vector<NamedTurn> turns() {
    const Turn any = turnByAngles({17, -64, 131});
    return {{"None", {}},
            {"AboutX", turnByAngles({40, 0, 0})},
            {"AboutY", turnByAngles({0, 77.7, 0})},
            {"AboutZ", turnByAngles({0, 0, -111})},
            {"AboutAll", any},
            {"Mirrored", mirrored({})},
            {"TurnedAndMirrored", mirrored(any)}};
}

Vec3d randomDirection(std::mt19937_64& generator) {
    std::normal_distribution<double> normal;
    const double x = normal(generator), y = normal(generator), z = normal(generator);
    return Vec3d(x, y, z).normalized();
}

TEST(Turn, AnglesGoAboutXThenYThenZ) {
    const auto expectNear = [](const Vec3d& a, const Vec3d& b) {
        EXPECT_LT((a - b).length(), 1e-12) << a << b;
    };
    const Vec3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    expectNear(turnByAngles({90, 0, 0}).apply(y), z);
    expectNear(turnByAngles({0, 90, 0}).apply(z), x);
    expectNear(turnByAngles({0, 0, 90}).apply(x), y);
    std::mt19937_64 generator(2);
    for (int i = 0; i < 20; ++i) {
        const Vec3d w = randomDirection(generator), degrees(31.0 * i, -57.0 * i, 101.0 * i);
        const Vec3d byX = turnByAngles({degrees.x, 0, 0}).apply(w);
        const Vec3d byY = turnByAngles({0, degrees.y, 0}).apply(byX);
        expectNear(turnByAngles(degrees).apply(w), turnByAngles({0, 0, degrees.z}).apply(byY));
        expectNear(turnByAngles(degrees).undo(turnByAngles(degrees).apply(w)), w);
    }
}

class Turned : public testing::TestWithParam<std::size_t> {
protected:
    Turn turn_ = turns()[GetParam()].turn;
};

INSTANTIATE_TEST_SUITE_P(Turns, Turned, testing::Range<std::size_t>(0, turns().size()),
                         [](const auto& test) { return turns()[test.param].name; });

TEST_P(Turned, RadianceIsThatOfTheMap) {
    const Image image = test::noiseMap(200, 90, 2);
    const Environment environment(mapOf(image), turn_);
    std::mt19937_64 generator(5);
    int compared = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vec3d w = randomDirection(generator);
        const auto texel = test::texelAt(image.width, image.height, w);
        // Within rounding of a texel's border either neighbour will do.
        if (texel != test::texelAt(image.width, image.height, (w + Vec3d(1e-5)).normalized()) ||
            texel != test::texelAt(image.width, image.height, (w - Vec3d(1e-5)).normalized()))
            continue;
        ++compared;
        EXPECT_EQ(environment.radiance(Vec3f(turn_.apply(w))),
                  image.pixels[static_cast<std::size_t>(texel[1] * image.width + texel[0])]);
    }
    EXPECT_GT(compared, 1500);
}

/// Luminance of a map in each tile of the sphere, from its texels alone, as if turned by `turn`.
std::vector<double> lightOfTiles(const Environment& plain, const Turn& turn, const Rgb& tint) {
    constexpr int kParts = 3;  ///< along a side of a texel
    std::vector<double> tiles(cellCount(kTileLevel));
    for (std::size_t i = 0; i < plain.texelCount(); ++i) {
        const Environment::Texel texel = plain.texel(i);
        const double light = static_cast<double>(plain.luminance(texel.radiance * tint)) *
                             static_cast<double>(texel.solidAngle) / (kParts * kParts);
        for (int y = 0; y < kParts; ++y)
            for (int x = 0; x < kParts; ++x)
                tiles[locateCell(kTileLevel, turn.apply(plain.placeIn(i, (x + 0.5) / kParts,
                                                                      (y + 0.5) / kParts)))] +=
                    light;
    }
    return tiles;
}

std::vector<double> histogram(const Environment& environment, int samples) {
    std::vector<double> tiles(cellCount(kTileLevel));
    std::mt19937_64 generator(7);
    std::uniform_real_distribution<double> uniform;
    std::uniform_real_distribution<float> place;
    for (int i = 0; i < samples; ++i) {
        const EnvironmentSample s =
            environment.sample(uniform(generator), place(generator), place(generator));
        tiles[locateCell(kTileLevel, Vec3d(s.direction))] += 1;
    }
    return tiles;
}

double pValue(const std::vector<double>& observed, std::vector<double> light, int samples) {
    double total = 0;
    for (const double x : light) total += x;
    for (double& x : light) x *= samples / total;
    return test::chiSquaredPValue(observed, light);
}

// With its controls: the map turned by 1 degree and by 5 degrees more is seen in the tiles, though
// its mean is the same.
TEST_P(Turned, SamplesFollowTheTurnedLight) {
    constexpr int kSamples = 400000;
    const auto map = mapOf(test::litMap("courtyard").map);
    const std::vector<double> observed = histogram(Environment(map, turn_), kSamples);
    const Environment plain(map);
    const auto after = [&](const Turn& more) {
        Turn both;
        for (std::size_t k = 0; k < 3; ++k) both.axis[k] = more.apply(turn_.axis[k]);
        return pValue(observed, lightOfTiles(plain, both, Rgb(1.0f)), kSamples);
    };
    const double level = test::significance(1);
    EXPECT_GT(after({}), level);
    for (const double degrees : {1.0, 5.0}) {
        EXPECT_LT(after(turnByAngles({degrees, 0, 0})), level);
        EXPECT_LT(after(turnByAngles({0, degrees, 0})), level);
    }
}

TEST_P(Turned, DensitiesAreThoseOfTheDraws) {
    for (const char* name : {"Noise", "sunrise", "Sun"}) {
        const Environment environment(mapOf(test::litMap(name).map), turn_, Rgb(2, 0.5f, 0));
        double total = 0;
        for (std::size_t i = 0; i < environment.texelCount(); ++i) {
            const Environment::Texel texel = environment.texel(i);
            total += static_cast<double>(texel.solidAngle) *
                     static_cast<double>(environment.lookUp(texel.center).density);
        }
        EXPECT_NEAR(total, 1, 1e-5) << name;
        for (std::uint64_t i = 0; i < 20000; ++i) {
            const EnvironmentSample s = environment.sample(toUnit(hashWords(i, 1)), 0.4f, 0.7f);
            const EnvironmentSample found = environment.lookUp(s.direction);
            EXPECT_NEAR(found.density / s.density, 1, 1e-5);
            EXPECT_EQ(found.radiance, s.radiance);
            EXPECT_EQ(found.cell, s.cell);
            EXPECT_EQ(found.texel, s.texel);
        }
    }
}

/// Sums of the moments of all cells: the first ones of each colour.
std::array<Vec3d, 3> firstMoments(const Environment& environment) {
    std::array<Vec3d, 3> sums{Vec3d(0.0), Vec3d(0.0), Vec3d(0.0)};
    for (std::uint32_t c = 0; c < cellCount(Environment::kLevel); ++c) {
        const CellMoments& m = environment.cells(Environment::kLevel, c / CellMoments::kSize);
        for (std::size_t color = 0; color < 3; ++color)
            for (int axis = 0; axis < 3; ++axis)
                sums[color][axis] +=
                    static_cast<double>(m.firstMoment[color][axis][c % CellMoments::kSize]);
    }
    return sums;
}

// Ten texels of this map hold more than half of its light.
TEST(TurnedSun, KeepsItsIntegralUnderEveryTurn) {
    const auto map = mapOf(test::litMap("sunrise").map);
    const Environment plain(map);
    Environment environment(map);
    std::mt19937_64 generator(3);
    std::uniform_real_distribution<double> angle(-180, 180);
    for (int i = 0; i < 40; ++i) {
        Turn turn = turnByAngles({angle(generator), angle(generator), angle(generator)});
        if (i % 2 == 1) turn = mirrored(turn);
        environment.turn(turn, Rgb(1.0f));
        EXPECT_NEAR(environment.luminanceIntegral() / plain.luminanceIntegral(), 1, 1e-6);
        for (std::size_t color = 0; color < 3; ++color) {
            const Vec3d expected = turn.apply(firstMoments(plain)[color]);
            EXPECT_LT((firstMoments(environment)[color] - expected).length(),
                      1e-6 * expected.length());
        }
    }
}

// Cells hold what belongs to them: their moments are those of their texels.
TEST_P(Turned, MomentsAreSumsOverTexels) {
    const Environment environment(mapOf(test::litMap("interior").map), turn_, Rgb(1, 3, 0.25f));
    for (std::uint32_t c = 0; c < cellCount(Environment::kLevel); c += 41) {
        const CellMoments& m = environment.cells(Environment::kLevel, c / CellMoments::kSize);
        const std::uint32_t k = c % CellMoments::kSize;
        Vec3d first(0.0);
        double square = 0, light = 0;
        const Vec3d axis(Vec3f(m.axis[0][k], m.axis[1][k], m.axis[2][k]));
        environment.forEachTexel(c, [&](std::uint32_t i) {
            const Environment::Texel texel = environment.texel(i);
            const double amount = static_cast<double>(texel.solidAngle * texel.radiance.y);
            light += amount;
            for (const double x : {0.211325, 0.788675})  // Gauss and Legendre
                for (const double y : {0.211325, 0.788675}) {
                    const Vec3d w = environment.placeIn(i, x, y);
                    first += w * (amount / 4);
                    square += w.x * w.y * (amount / 4);
                }
            for (const double x : {0.0, 1.0})
                for (const double y : {0.0, 1.0})
                    EXPECT_LE(axis.cross(environment.placeIn(i, x, y)).length(),
                              static_cast<double>(m.sinRadius[k]));
        });
        // The solid angles of texels are differences of single precision.
        for (int j = 0; j < 3; ++j)
            EXPECT_NEAR(static_cast<double>(m.firstMoment[1][j][k]), first[j], 1e-4 * light);
        EXPECT_NEAR(static_cast<double>(m.second[1][3][k]), square, 1e-4 * light);
    }
}

TEST(Gain, IsLinear) {
    const auto map = mapOf(test::litMap("interior").map);
    const Turn turn = turnByAngles({10, 20, 30});
    const Environment one(map, turn), four(map, turn, Rgb(4.0f));
    EXPECT_EQ(four.luminanceIntegral(), 4 * one.luminanceIntegral());
    for (std::uint64_t i = 0; i < 1000; ++i) {
        const EnvironmentSample a = one.sample(toUnit(hashWords(i, 1)), 0.3f, 0.6f);
        const EnvironmentSample b = four.sample(toUnit(hashWords(i, 1)), 0.3f, 0.6f);
        EXPECT_EQ(a.direction, b.direction);
        EXPECT_EQ(a.density, b.density);
        EXPECT_EQ(a.radiance * 4.0f, b.radiance);
        EXPECT_EQ(one.radiance(a.direction) * 4.0f, four.radiance(a.direction));
    }
    for (std::size_t color = 0; color < 3; ++color)
        EXPECT_EQ(firstMoments(four)[color], firstMoments(one)[color] * 4);
}

// With its control: samples of the plain map do not follow the light of the tinted one.
TEST(Gain, ATintIsFollowedByTheSamples) {
    constexpr int kSamples = 400000;
    const auto map = mapOf(test::litMap("courtyard").map);
    const Rgb tint(3, 1, 0);
    const Environment plain(map), tinted(map, {}, tint);
    const std::vector<double> light = lightOfTiles(plain, {}, tint);
    EXPECT_GT(pValue(histogram(tinted, kSamples), light, kSamples), test::significance(1));
    EXPECT_LT(pValue(histogram(plain, kSamples), light, kSamples), test::significance(1));
}

TEST(Gain, OfZeroIsDark) {
    const Environment environment(mapOf(test::noiseMap(64, 32, 9)), {}, Rgb(0.0f));
    EXPECT_EQ(environment.luminanceIntegral(), 0);
    const EnvironmentSample s = environment.lookUp(Vec3f(0, 1, 0));
    EXPECT_EQ(s.radiance, Rgb(0, 0, 0));
    EXPECT_EQ(s.density, 0.0f);
}

TEST(TurnedAgain, IsTheSameAsANewOne) {
    const auto map = mapOf(test::litMap("interior").map);
    const Turn turn = mirrored(turnByAngles({50, 60, 70}));
    const Environment fresh(map, turn, Rgb(1, 2, 3));
    Environment again(map, turnByAngles({0, 5, 0}));
    again.turn(turn, Rgb(1, 2, 3));
    EXPECT_EQ(fresh.luminanceIntegral(), again.luminanceIntegral());
    for (std::uint64_t i = 0; i < 1000; ++i) {
        const double u = toUnit(hashWords(i, 4));
        const EnvironmentSample a = fresh.sample(u, 0.5f, 0.5f), b = again.sample(u, 0.5f, 0.5f);
        EXPECT_EQ(a.direction, b.direction);
        EXPECT_EQ(a.density, b.density);
        EXPECT_EQ(a.radiance, b.radiance);
    }
}

}  // namespace
}  // namespace shadowcache
