// What is drawn by the shares of regions, and the density that estimates divide by: one
// distribution.

#include "render/regions/region_distribution.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "common/math/direction_mesh.h"
#include "common/random/sequence.h"
#include "render/cached/lobe_light.h"
#include "render/cached/place_lookup.h"
#include "render/regions/cosine_integrand.h"
#include "render/regions/lobe_integrand.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

constexpr int kCountLevel = 2;

/// A place beside a slab that hides a part of a map, and what is drawn there for the irradiance and
/// for a lobe.
class Drawn : public testing::Test {
protected:
    Drawn() {
        const DirectionTiers tiers = world_.cache.cache().header().tiers();
        const ShadingPoint point = world_.below();
        PlaceLookup lookup(world_.cache.cache());
        lookup.pool(world_.scene, point.place, 0);
        const CellSplitter splitter(world_.environment, tiers);
        RegionBuilder<CosineIntegrand> ofCosine(world_.environment, tiers);
        const Regions& regions =
            ofCosine
                .build(CosineIntegrand(world_.environment, splitter, point.place.normal, 0, 0),
                       lookup.pooled(), Calibration())
                .regions;
        ofIrradiance_.assign(regions, RegionSharer().share(regions, 64, {0, 0.4}, 0.045));
        const GlossyLobe lobe(glossy(Rgb(0.9f, 0.6f, 0.3f), {.metallic = 1, .roughness = 0.3f}),
                              point.place.normal, Vec3f(0.5f, 0.8f, 0.2f).normalized());
        const QuadraticCells cells(world_.environment, tiers);
        RegionBuilder<LobeIntegrand> ofLobes(world_.environment, tiers);
        const Regions& ofLobe = ofLobes
                                    .build(LobeIntegrand(world_.environment, cells, tiers,
                                                         splitter.leastNoise(), lobe, 0.01f),
                                           lookup.pooled(), Calibration())
                                    .regions;
        ofLobe_.assign(ofLobe, RegionSharer(lobeRules()).share(ofLobe, 64, {0, 0.2}, 0.02));
    }

    std::uint32_t binOf(const Vec3f& direction) const {
        return ancestorCell(world_.environment.lookUp(direction).cell, Environment::kLevel,
                            kCountLevel);
    }

    /// Integral of pdf() times `tilt` over each bin.
    std::vector<double> expected(const RegionDistribution& distribution,
                                 const std::function<double(const Vec3f&)>& tilt) const {
        std::vector<double> sums(cellCount(kCountLevel));
        for (std::size_t i = 0; i < world_.environment.texelCount(); ++i) {
            const Environment::Texel texel = world_.environment.texel(i);
            sums[binOf(texel.center)] += tilt(texel.center) * distribution.pdf(texel.center) *
                                         static_cast<double>(texel.solidAngle);
        }
        return sums;
    }

    std::vector<double> observed(const RegionDistribution& distribution,
                                 std::uint64_t draws) const {
        std::vector<double> counts(cellCount(kCountLevel));
        for (std::uint64_t k = 0; k < draws; ++k) {
            const EnvironmentSample s =
                distribution.sample(toUnit(hashWords(k, 1)), toUnitFloat(0x80000000u), 0.5f);
            ++counts[binOf(s.direction)];
        }
        return counts;
    }

    std::array<const RegionDistribution*, 2> all() const { return {&ofIrradiance_, &ofLobe_}; }

    test::World world_{test::slabMesh(), test::noiseMap(64, 32, 7)};
    RegionDistribution ofIrradiance_{world_.environment}, ofLobe_{world_.environment};
};

double totalOf(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum;
}

// With its control: a density that is tilted by four per cent is rejected.
TEST_F(Drawn, DirectionsFollowTheDensity) {
    constexpr std::uint64_t kDraws = 1000000;
    for (const RegionDistribution* distribution : all()) {
        const std::vector<double> counts = observed(*distribution, kDraws);
        const auto pValue = [&](double tilt) {
            std::vector<double> wanted = expected(*distribution, [&](const Vec3f& w) {
                return 1 + tilt * static_cast<double>(w.x + w.z);
            });
            const double scale = static_cast<double>(kDraws) / totalOf(wanted);
            for (double& count : wanted) count *= scale;
            return test::chiSquaredPValue(counts, wanted);
        };
        EXPECT_GT(pValue(0), test::significance(2));
        EXPECT_LT(pValue(0.04), test::significance(2));
    }
}

TEST_F(Drawn, DensityIntegratesToOne) {
    for (const RegionDistribution* distribution : all())
        EXPECT_NEAR(totalOf(expected(*distribution, [](const Vec3f&) { return 1; })), 1, 1e-4);
}

TEST_F(Drawn, DensityOfASampleIsThatAlongItsDirection) {
    for (const RegionDistribution* distribution : all())
        for (std::uint64_t k = 0; k < 5000; ++k) {
            // Not at a texel's border, where a direction may be rounded into the next.
            const auto inside = [&](std::uint64_t axis) {
                return static_cast<float>(0.1 + 0.8 * toUnit(hashWords(k, axis)));
            };
            const EnvironmentSample s =
                distribution->sample(toUnit(hashWords(k, 1)), inside(2), inside(3));
            const double density = distribution->pdf(s.direction);
            ASSERT_GT(density, 0);
            EXPECT_NEAR(static_cast<double>(s.density) / density, 1, 1e-4);
        }
}

// Numbers in ascending order choose as each alone does.
TEST_F(Drawn, AWalkChoosesWhatEachNumberChooses) {
    for (const RegionDistribution* distribution : all()) {
        RegionDistribution::Walk walk(*distribution);
        for (int k = 0; k < 1000; ++k) {
            const double u = (k + 0.5) / 1000;
            const RegionDistribution::Choice together = walk.next(u);
            const RegionDistribution::Choice alone =
                RegionDistribution::Walk(*distribution).next(u);
            EXPECT_EQ(together.place.group, alone.place.group);
            EXPECT_EQ(together.place.lane, alone.place.lane);
            EXPECT_NEAR(together.u, alone.u, 1e-9);
            EXPECT_DOUBLE_EQ(distribution->chance(alone.place) * alone.inverseChance, 1);
        }
    }
}

TEST_F(Drawn, NothingIsDrawnBelowTheHorizon) {
    for (const RegionDistribution* distribution : all())
        EXPECT_EQ(distribution->pdf(Vec3f(0, -1, 0)), 0);
    EXPECT_TRUE(RegionDistribution(world_.environment).empty());
}

}  // namespace
}  // namespace shadowcache
