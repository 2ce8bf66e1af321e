// Quadratics that stand in for a glossy lobe, and what is integrated and drawn of them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "common/math/direction_mesh.h"
#include "render/cached/cluster_sampler.h"
#include "render/cached/lobe_light.h"
#include "render/cached/place_lookup.h"
#include "render/regions/lobe_integrand.h"
#include "render/regions/lobe_match.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

constexpr DirectionTiers kTiers{5};

GlossyLobe lobeOf(float roughness, const Vec3f& toViewer,
                  const Rgb& color = Rgb(0.9f, 0.6f, 0.3f)) {
    return GlossyLobe(glossy(color, {.metallic = 1, .roughness = roughness}), Vec3f(0, 1, 0),
                      toViewer.normalized());
}

const Vec3f kSlanted(0.7f, 0.7f, 0.1f);

TEST(GlossyLobe, ValuesAreThoseOfOneDirectionAtATime) {
    for (const float metallic : {0.0f, 0.5f, 1.0f})
        for (const float roughness : {0.02f, 0.2f, 0.7f}) {
            const GlossyLobe lobe(
                glossy(Rgb(0.9f, 0.5f, 0.2f), {.metallic = metallic, .roughness = roughness}),
                Vec3f(0.6f, 0.8f, 0), kSlanted.normalized());
            float direction[3][GlossyLobe::kLanes], values[3][GlossyLobe::kLanes];
            for (std::uint32_t i = 0; i < GlossyLobe::kLanes; ++i) {
                const Vec3f w =
                    i < 8 ? lobe.sample(toUnitFloat(i << 28), 0.3f) : Vec3f(cellCenter(2, i * 19));
                for (int k = 0; k < 3; ++k) direction[k][i] = w[k];
            }
            lobe.values(direction, values);
            for (int i = 0; i < GlossyLobe::kLanes; ++i) {
                const Rgb one = lobe.value({direction[0][i], direction[1][i], direction[2][i]});
                for (int k = 0; k < 3; ++k)
                    EXPECT_NEAR(values[k][i], one[k], 2e-3f * std::abs(one[k]) + 1e-6f);
            }
        }
}

/// Fits `value` in the cells of a block.
template <class Value>
QuadraticFit fitOf(const QuadraticBlock& cells, const Value& value) {
    PlaceValues values;
    for (int p = 0; p < QuadraticBlock::kPlaces; ++p)
        for (int i = 0; i < kBlockCells; ++i) {
            const Rgb v =
                value(Vec3f(cells.place[p][0][i], cells.place[p][1][i], cells.place[p][2][i]));
            for (int k = 0; k < 3; ++k) values[p][k][i] = v[k];
        }
    QuadraticFit fit;
    fitQuadratic(cells, values, fit);
    return fit;
}

// A quadratic is its own fit, and its integral is the map's. The other side is a sum over places in
// the texels.
TEST(QuadraticCells, OfAQuadraticAreItself) {
    const Environment map = test::environmentOf(test::noiseMap(64, 32, 5));
    const QuadraticCells cells(map, kTiers);
    const auto value = [](const Vec3f& w) {
        return Rgb(w.x * w.x + 0.5f * w.y * w.z, 1, w.z * w.z - w.x * w.y);
    };
    for (const int level : {1, 3, 5}) {
        const std::uint32_t block = level == 1 ? 3 : 7;
        const QuadraticBlock& at = cells.block(level, block);
        const QuadraticFit fit = fitOf(at, value);
        float integral[3][kBlockCells], within[kBlockCells];
        integrateQuadratic(at, fit, integral);
        for (int p = 0; p < 3; ++p)
            for (int k = 0; k < 3; ++k) {
                fitWithin(at, fit, p, k, within);
                const auto& place = at.place[QuadraticBlock::kNodes + p];
                for (int i = 0; i < kBlockCells; ++i)
                    EXPECT_NEAR(within[i], value({place[0][i], place[1][i], place[2][i]})[k], 1e-5);
            }
        for (std::uint32_t i = 0; i < kBlockCells; ++i) {
            const std::uint32_t cell = block * kBlockCells + i;
            Vec3d sum(0.0), scale(0.0);
            const int shift = 2 * (Environment::kLevel - level);
            const auto add = [&](std::uint32_t t) {
                for (int j = 0; j < 4; ++j) {
                    // Two nodes of Gauss and Legendre a side.
                    const Vec3f w(
                        map.placeIn(t, j % 2 ? 0.788675 : 0.211325, j / 2 ? 0.788675 : 0.211325));
                    const Environment::Texel texel = map.texel(t);
                    const Vec3d light(texel.radiance * (texel.solidAngle / 4));
                    sum += Vec3d(value(w)) * light;
                    scale += light;
                    const Rgb found = cells.value(fit, level, cell, w);
                    EXPECT_LT((found - value(w)).length(), 2e-3f);
                }
            };
            for (std::uint32_t fine = cell << shift; fine < (cell + 1) << shift; ++fine)
                map.forEachTexel(fine, add);
            for (int k = 0; k < 3; ++k)
                EXPECT_NEAR(static_cast<double>(integral[k][i]), sum[k], 3e-4 * scale[k]) << level;
        }
    }
}

TEST(QuadraticCells, AConstantIsAConstant) {
    const Environment map = test::environmentOf(test::constantMap(Rgb(1, 1, 1)));
    const QuadraticCells cells(map, kTiers);
    QuadraticFit fit{};
    setConstant(cells.block(3, 2), 5, Rgb(0.25f, 2, 7), fit);
    const Vec3f w(cellCenter(3, 37));
    EXPECT_LT((cells.value(fit, 3, 37, w) - Rgb(0.25f, 2, 7)).length(), 1e-4f);
}

/// Error of the fits of a lobe over all cells of a level, as a share of the lobe's square.
double fitError(const QuadraticCells& cells, int level, const GlossyLobe& lobe) {
    double error = 0, square = 0;
    for (std::uint32_t b = 0; b < cellCount(level) / kBlockCells; ++b) {
        const QuadraticFit fit =
            fitOf(cells.block(level, b), [&](const Vec3f& w) { return lobe.value(w); });
        for (std::uint32_t i = 0; i < kBlockCells; ++i)
            for (std::uint32_t child = 0; child < 64; ++child) {
                const std::uint32_t cell = b * kBlockCells + i;
                const Vec3f w(cellCenter(level + 3, 64 * cell + child));
                if (!(w.y > 0)) continue;
                const Rgb found = cells.value(fit, level, cell, w), wanted = lobe.value(w);
                error += static_cast<double>((found - wanted).length2());
                square += static_cast<double>(wanted.length2());
            }
    }
    return std::sqrt(error / square);
}

// The narrower a lobe, the finer the cells that follow it.
TEST(QuadraticCells, FollowLobesAsFarAsTheirSizeAllows) {
    const QuadraticCells cells(test::environmentOf(test::constantMap(Rgb(1, 1, 1))), kTiers);
    EXPECT_LT(fitError(cells, 3, lobeOf(0.5f, kSlanted)), 0.02);
    EXPECT_LT(fitError(cells, 5, lobeOf(0.2f, kSlanted)), 0.02);
    EXPECT_GT(fitError(cells, 3, lobeOf(0.2f, kSlanted)), 0.1);
    EXPECT_GT(fitError(cells, 5, lobeOf(0.08f, kSlanted)), 0.1);
}

TEST(LobeMatch, FindsTheFactorOfEachColor) {
    const GlossyLobe gold = lobeOf(0.3f, kSlanted, Rgb(0.9f, 0.6f, 0.3f));
    const LobeMatch match(gold);
    const LobeMatch::Fit same = match.fit(gold);
    EXPECT_LT(same.misfit, 1e-5f);
    EXPECT_LT((same.factor - Rgb(1.0f)).length(), 1e-4f);
    const LobeMatch::Fit darker = match.fit(lobeOf(0.3f, kSlanted, Rgb(0.45f, 0.6f, 0.1f)));
    EXPECT_LT(darker.misfit, 0.02f);
    EXPECT_LT((darker.factor - Rgb(0.5f, 1, 1 / 3.0f)).length(), 0.1f);
    const LobeMatch::Fit other = match.fit(lobeOf(0.3f, Vec3f(-0.7f, 0.7f, 0.1f)));
    EXPECT_GT(other.misfit, 0.5f);
    EXPECT_EQ(other.factor, Rgb(0.0f));
}

/// A lobe beside a slab that hides a part of a map, with its regions.
class GlossyRegionsTest : public testing::Test {
protected:
    GlossyRegionsTest() {
        PlaceLookup lookup(world_.cache.cache());
        lookup.pool(world_.scene, point_.place, 0);
        const DirectionTiers tiers = world_.cache.cache().header().tiers();
        RegionBuilder<LobeIntegrand> builder(world_.environment, tiers);
        const float leastNoise = CellSplitter(world_.environment, tiers).leastNoise();
        glossy_ = builder.build(
            LobeIntegrand(world_.environment, cells_, tiers, leastNoise, lobe_, 0.01f),
            lookup.pooled(), Calibration());
        shares_ = RegionSharer(lobeRules()).share(glossy_.regions, 64, {0, 0.2}, 0.02);
        distribution_.assign(glossy_.regions, shares_);
    }

    test::World world_{test::slabMesh(), test::noiseMap(64, 32, 7)};
    ShadingPoint point_ = world_.below();
    GlossyLobe lobe_ = lobeOf(0.2f, Vec3f(0.5f, 0.8f, 0.2f));
    QuadraticCells cells_{world_.environment, world_.cache.cache().header().tiers()};
    FittedRegions<LobeIntegrand> glossy_;
    RegionShares shares_;
    RegionDistribution distribution_{world_.environment};
};

TEST_F(GlossyRegionsTest, AreFinestInsideTheLobe) {
    const Vec3f mirrored = lobe_.mirrored();
    int finest = 0, fitted = 0;
    for (std::size_t g = 0; g < glossy_.regions.groups.size(); ++g) {
        const RegionGroup& group = glossy_.regions.groups[g];
        finest = std::max(finest, group.level);
        for (int i = 0; i < kBlockCells; ++i) {
            if (!(group.light[i] > 0)) continue;
            const std::uint32_t cell = group.firstCell + static_cast<std::uint32_t>(i);
            const std::uint32_t some = cell << 2 * (Environment::kLevel - group.level);
            const RegionPlace place = distribution_.find(some);
            EXPECT_EQ(place.group, g);
            EXPECT_EQ(place.lane, i);
            fitted += group.visibility[i] > 0;
        }
    }
    const std::uint32_t peak = locateCell(Environment::kLevel, Vec3d(mirrored));
    const RegionPlace place = distribution_.find(peak);
    ASSERT_TRUE(place.found());
    EXPECT_EQ(glossy_.regions.groups[place.group].level, finest);
    EXPECT_GT(fitted, 50);
    const std::uint32_t below = locateCell(Environment::kLevel, Vec3d(0, -1, 0));
    EXPECT_FALSE(distribution_.find(below).found());
}

// The integral is the mean of what samples of the regions subtract. With its control: 5 % more is
// rejected.
TEST_F(GlossyRegionsTest, IntegralIsWhatSamplesSubtract) {
    ClusterSampler sampler(world_.environment);
    std::vector<SampleCount> shares;
    const std::uint32_t member = 0;
    std::vector<double> values;
    for (std::uint64_t k = 0; k < 12000; ++k) {
        point_.slot.seed = hashWords(k, 3);
        const PointBatch batch{{&point_, 1}, 32};
        roundCounts(std::array{32.0}, 0, shares);
        double sum = 0;
        for (const ClusterSample& sample :
             sampler.draw(batch, {&member, 1}, shares, distribution_, Sequence::kSobol)) {
            const EnvironmentSample s = sample.finish(world_.environment);
            const RegionGroup& group = glossy_.regions.groups[sample.place.group];
            const Rgb fitted = cells_.value(
                glossy_.fits[sample.place.group], group.level,
                group.firstCell + static_cast<std::uint32_t>(sample.place.lane), s.direction);
            sum += static_cast<double>(
                s.radiance.y * sample.inverseCount / s.density * fitted.y *
                shares_.groups[sample.place.group].visibility[sample.place.lane]);
        }
        values.push_back(sum);
    }
    const auto integral = static_cast<double>(integralOf(cells_, glossy_, shares_).y);
    EXPECT_GT(integral, 0);
    EXPECT_GT(test::meanPValue(values, integral), test::significance(1));
    EXPECT_LT(test::meanPValue(values, integral * 1.05), test::significance(1));
}

}  // namespace
}  // namespace shadowcache
