// Integrals are those of the map; samplers follow their densities.

#include "common/light/environment.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/random/sequence.h"
#include "tests/support/environment_maps.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

using test::environmentOf;

using test::NamedMap;
using test::Texels;
using test::unturned;

class EnvironmentMaps : public testing::TestWithParam<std::string> {
protected:
    NamedMap named_ = test::litMap(GetParam());
    Environment environment_ = environmentOf(named_.map, named_.rotation);

    void expectPower();
    void expectRadiance();
    void expectMoments(const Texels& texels);
    void expectRadii(const Texels& texels);
    void expectSample(const Texels& texels);
    void expectSampleCell(const Texels& texels);
    void expectPlaces(const Texels& texels);
};

INSTANTIATE_TEST_SUITE_P(Maps, EnvironmentMaps, testing::ValuesIn(test::litMapNames()),
                         [](const auto& test) { return test.param; });

/// The total luminance is that of the map.
void EnvironmentMaps::expectPower() {
    double wanted = 0;
    const Image& map = named_.map;
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x)
            wanted += 2 * kPi / map.width *
                      (std::cos(kPi * y / map.height) - std::cos(kPi * (y + 1) / map.height)) *
                      static_cast<double>(environment_.luminance(
                          map.pixels[static_cast<std::size_t>(y * map.width + x)]));
    EXPECT_NEAR(environment_.luminanceIntegral() / wanted, 1, 1e-6);
}

/// Radiance is that of the map's texel along the turned direction.
void EnvironmentMaps::expectRadiance() {
    const Image& map = named_.map;
    std::mt19937_64 generator(5);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 2000; ++i) {
        const Vec3d w = Vec3d(normal(generator), normal(generator), normal(generator)).normalized();
        const Vec3d u = unturned(w, named_.rotation * kPi / 180);
        const auto texel = test::texelAt(map.width, map.height, u);
        // Within rounding of a texel's border either neighbour will do.
        if (texel != test::texelAt(map.width, map.height, (u + Vec3d(1e-6)).normalized()) ||
            texel != test::texelAt(map.width, map.height, (u - Vec3d(1e-6)).normalized()))
            continue;
        EXPECT_EQ(environment_.radiance(Vec3f(w)),
                  map.pixels[static_cast<std::size_t>(texel[1] * map.width + texel[0])])
            << w;
    }
}

/// Moments are sums over the texels, and over the cells below.
void EnvironmentMaps::expectMoments(const Texels& texels) {
    const Vec3d zero(0.0);
    std::vector<std::array<Vec3d, 3>> firstMoment(cellCount(Environment::kLevel),
                                                  {zero, zero, zero});
    std::vector<double> luminance(firstMoment.size(), 0.0);
    for (std::size_t i = 0; i < texels.size(); ++i) {
        const Rgb radiance = environment_.texel(i).radiance;
        const std::uint32_t cell = texels.cell(i, Environment::kLevel);
        const Vec3d moment = texels.moment(i);
        for (std::size_t c = 0; c < 3; ++c)
            firstMoment[cell][c] += moment * static_cast<double>(radiance[static_cast<int>(c)]);
        luminance[cell] += texels.luminanceIntegral(i);
    }
    for (int level = Environment::kLevel; level >= 0; --level) {
        double sum = 0;
        for (std::uint32_t cell = 0; cell < cellCount(level); ++cell) {
            const CellMoments& m = environment_.cells(level, cell / 16);
            const std::size_t k = cell % 16;
            sum += environment_.luminanceIntegral(level, cell);
            EXPECT_NEAR(environment_.luminanceIntegral(level, cell), luminance[cell],
                        1e-3 * luminance[cell]);
            EXPECT_NEAR(static_cast<double>(m.luminanceIntegral[k]),
                        environment_.luminanceIntegral(level, cell), 1e-7 * luminance[cell]);
            for (std::size_t c = 0; c < 3; ++c)
                for (int axis = 0; axis < 3; ++axis)
                    EXPECT_NEAR(
                        static_cast<double>(m.firstMoment[c][static_cast<std::size_t>(axis)][k]),
                        firstMoment[cell][c][axis], 1e-6 * firstMoment[cell][c].length())
                        << level << " " << cell;
        }
        EXPECT_NEAR(sum / environment_.luminanceIntegral(), 1, 1e-12);
        for (std::size_t cell = 0; cell < firstMoment.size() / 4; ++cell) {
            luminance[cell] = luminance[4 * cell] + luminance[4 * cell + 1] +
                              luminance[4 * cell + 2] + luminance[4 * cell + 3];
            for (std::size_t c = 0; c < 3; ++c)
                firstMoment[cell][c] = firstMoment[4 * cell][c] + firstMoment[4 * cell + 1][c] +
                                       firstMoment[4 * cell + 2][c] + firstMoment[4 * cell + 3][c];
        }
        firstMoment.resize(firstMoment.size() / 4);
        luminance.resize(luminance.size() / 4);
    }
}

/// Cells hold their texels within their radius.
void EnvironmentMaps::expectRadii(const Texels& texels) {
    for (std::size_t i = 0; i < texels.size(); i += 101) {
        const Environment::Texel t = environment_.texel(i);
        for (int level = 0; level <= Environment::kLevel; ++level) {
            const std::uint32_t cell = texels.cell(i, level);
            const CellMoments& m = environment_.cells(level, cell / 16);
            const std::size_t k = cell % 16;
            const Vec3d axis(Vec3f(m.axis[0][k], m.axis[1][k], m.axis[2][k]));
            EXPECT_LE(axis.cross(Vec3d(t.center)).length(), static_cast<double>(m.sinRadius[k]));
        }
    }
}

/// How much of [0, 1) leads to each texel, against its density times its solid angle: no more than
/// a step of the grid apart, whatever the map. `luminance` is that of all texels which `draw` may
/// give.
template <class Draw>
void expectSharesMatch(const Texels& texels, int steps, double luminance, const Draw& draw) {
    struct Tally {
        int hits = 0;
        double share = 0;
    };
    std::unordered_map<std::size_t, Tally> tallies;
    for (int i = 0; i < steps; ++i) {
        // Off the texel's border: which one was drawn must be beyond doubt.
        const double random = toUnit(hashWords(3, static_cast<std::uint64_t>(i)));
        const EnvironmentSample s =
            draw((i + 0.5) / steps, static_cast<float>(0.05 + 0.9 * random));
        const std::size_t texel = texels.along(s.direction);
        Tally& tally = tallies[texel];
        ++tally.hits;
        tally.share = static_cast<double>(s.density) * texels.solidAngle(texel);
    }
    double total = 0, seen = 0, worst = 0;
    for (const auto& [texel, tally] : tallies) {
        total += tally.share;
        seen += texels.luminanceIntegral(texel) / luminance;
        worst = std::max(worst, std::abs(tally.share * steps - tally.hits));
        EXPECT_GT(texels.luminanceIntegral(texel), 0);
    }
    EXPECT_LT(worst, 1.2);
    EXPECT_NEAR(total, seen, 2e-3);  // the dimmest cells get a little more than their due
    EXPECT_LT(total, 1 + 1e-5);
}

void EnvironmentMaps::expectSample(const Texels& texels) {
    expectSharesMatch(
        texels, 300000, environment_.luminanceIntegral(), [&](double u, float jitter) {
            const EnvironmentSample s = environment_.sample(u, jitter, 1 - jitter);
            EXPECT_EQ(environment_.radiance(s.direction), s.radiance);
            EXPECT_NEAR(environment_.lookUp(s.direction).density / s.density, 1, 1e-5);
            return s;
        });
    double total = 0;
    for (std::size_t i = 0; i < texels.size(); ++i)
        total += texels.solidAngle(i) *
                 static_cast<double>(environment_.lookUp(environment_.texel(i).center).density);
    EXPECT_NEAR(total, 1, 1e-5);
}

void EnvironmentMaps::expectSampleCell(const Texels& texels) {
    for (int level = 0; level <= Environment::kLevel; ++level) {
        std::vector<std::uint32_t> lit;
        for (std::uint32_t c = 0; c < cellCount(level); ++c)
            if (environment_.luminanceIntegral(level, c) > 0) lit.push_back(c);
        ASSERT_FALSE(lit.empty());
        for (std::size_t k = 0; k < 5; ++k) {
            const std::uint32_t cell = lit[(lit.size() - 1) * k / 4];
            SCOPED_TRACE(fmt::format("level {} cell {}", level, cell));
            const double luminance = environment_.luminanceIntegral(level, cell);
            expectSharesMatch(texels, 16000 >> level, luminance, [&](double u, float jitter) {
                const EnvironmentSample s =
                    environment_.sampleCell(level, cell, u, jitter, 1 - jitter);
                EXPECT_EQ(texels.cell(texels.along(s.direction), level), cell);
                return s;
            });
        }
    }
}

/// Places in a texel are uniform: their mean is its moment.
void EnvironmentMaps::expectPlaces(const Texels& texels) {
    constexpr int kGrid = 64;
    for (const double u : {0.001, 0.3, 0.77, 0.9999}) {
        const std::size_t i = texels.along(environment_.sample(u, 0.5f, 0.5f).direction);
        Vec3d mean(0, 0, 0);
        for (int a = 0; a < kGrid; ++a)
            for (int b = 0; b < kGrid; ++b)
                mean += Vec3d(environment_
                                  .sample(u, (static_cast<float>(a) + 0.5f) / kGrid,
                                          (static_cast<float>(b) + 0.5f) / kGrid)
                                  .direction);
        mean /= kGrid * kGrid;
        EXPECT_LT((mean.normalized() - texels.moment(i).normalized()).length(),
                  2e-3 * std::sqrt(texels.solidAngle(i)))
            << u;
    }
}

TEST_P(EnvironmentMaps, IntegralsAreThoseOfTheMap) {
    const Texels texels(environment_, named_.rotation);
    expectPower();
    expectRadiance();
    expectMoments(texels);
    expectRadii(texels);
}

TEST_P(EnvironmentMaps, SamplersFollowTheirDensities) {
    const Texels texels(environment_, named_.rotation);
    expectSample(texels);
    expectSampleCell(texels);
    expectPlaces(texels);
}

/// Chi-squared over 80 cells of how often samples land in each, u bent by `bend`.
template <class Bend>
double histogramPValue(const NamedMap& named, const Bend& bend) {
    constexpr int kLevel = 1, kSamples = 400000;
    const Environment environment = environmentOf(named.map, named.rotation);
    const Texels texels(environment, named.rotation);
    std::vector<double> observed(cellCount(kLevel)), expected(cellCount(kLevel));
    for (std::uint32_t c = 0; c < cellCount(kLevel); ++c)
        expected[c] =
            kSamples * environment.luminanceIntegral(kLevel, c) / environment.luminanceIntegral();
    std::mt19937_64 generator(7);
    std::uniform_real_distribution<double> uniform;
    for (int i = 0; i < kSamples; ++i) {
        const EnvironmentSample s = environment.sample(bend(uniform(generator)), 0.5f, 0.5f);
        observed[texels.cell(texels.along(s.direction), kLevel)] += 1;
    }
    return test::chiSquaredPValue(observed, expected);
}

// With its control where the light is spread: the test must see a 3 % tilt.
TEST_P(EnvironmentMaps, HistogramFollowsTheLight) {
    const double level = test::significance(1);
    EXPECT_GT(histogramPValue(named_, [](double u) { return u; }), level);
    const bool spread = named_.name == "Noise" || named_.name == "Gradient" ||
                        named_.name == "AllEqual" || named_.name == "courtyard";
    if (spread) {
        EXPECT_LT(histogramPValue(named_, [](double u) { return u * (0.97 + 0.03 * u); }), level);
    }
}

TEST(Environment, OfABlackMapIsBlack) {
    const Environment environment = environmentOf({4, 2, std::vector<Rgb>(8, Rgb(0, 0, 0))});
    EXPECT_EQ(environment.luminanceIntegral(), 0);
    const EnvironmentSample s = environment.lookUp(Vec3f(0, 1, 0));
    EXPECT_EQ(s.radiance, Rgb(0, 0, 0));
    EXPECT_EQ(s.density, 0.0f);
    for (int level = 0; level <= Environment::kLevel; ++level)
        for (std::uint32_t c = 0; c < cellCount(level); ++c) {
            EXPECT_EQ(environment.luminanceIntegral(level, c), 0);
            EXPECT_EQ(environment.cells(level, c / 16).luminanceIntegral[c % 16], 0.0f);
        }
}

TEST(Environment, RefusesAMapWithoutTexels) {
    test::expectError([] { environmentOf({0, 0, {}}); }, "environment map", "no texels");
    test::expectError([] { environmentOf({8, 0, {}}); }, "environment map", "no texels");
}

TEST(Environment, TakesItsLuminanceWeights) {
    const Image map = test::noiseMap(64, 32, 9);
    const Environment red(map, 0, Rgb(1, 0, 0));
    double wanted = 0;
    for (std::uint32_t c = 0; c < 20; ++c)
        for (int axis = 0; axis < 3; ++axis) {
            const CellMoments& m = red.cells(0, c / 16);
            wanted += static_cast<double>(m.firstMoment[0][axis][c % 16]) *
                      static_cast<double>(m.axis[axis][c % 16]);
        }
    EXPECT_EQ(red.luminance(Rgb(2, 3, 4)), 2.0f);
    // Light along the cells' axes is all of it but for the cells' width.
    EXPECT_LT(wanted, red.luminanceIntegral());
    EXPECT_GT(wanted, 0.8 * red.luminanceIntegral());
}

TEST(Environment, KnowsTheHighestLuminanceOfACone) {
    const NamedMap named = test::litMap("Noise");
    const Environment environment = environmentOf(named.map, named.rotation);
    std::mt19937_64 generator(8);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 200; ++i) {
        const Vec3d axis =
            i < 2 ? Vec3d(0, i ? 1 : -1, 0)
                  : Vec3d(normal(generator), normal(generator), normal(generator)).normalized();
        const double angle = 0.5 * toUnit(hashWords(4, static_cast<std::uint64_t>(i)));
        float highest = 0;
        Vec3d s, t;
        tangentFrame(axis, s, t);
        for (int k = 0; k < 500; ++k) {
            const double r = angle * std::sqrt((k + 0.5) / 500), phi = 2.4 * k;
            const Vec3f w(axis * std::cos(r) +
                          (s * std::cos(phi) + t * std::sin(phi)) * std::sin(r));
            highest = std::max(highest, environment.luminance(environment.radiance(w)));
        }
        EXPECT_GE(environment.maxLuminance(axis, angle), highest);
    }
}

}  // namespace
}  // namespace shadowcache
