// How many samples each region gets.

#include "render/cached/region_sampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "common/base/sequence.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

/// A place beside a ball, under noise with a small sun.
class RegionNumbers : public testing::Test {
protected:
    using Numbers = std::map<std::pair<int, std::uint32_t>, double>;  ///< by level and cell

    RegionNumbers() {
        ShadowCache::Reader reader(cache_.cache());
        const ShadingPoint point = test::pointAlong(scene_, {0.45f, 1, 0.2f}, {0, -1, 0});
        const int found = reader.lookUp(point.position, point.normal, items_);
        pooled_.pool(std::span(items_).first(static_cast<std::size_t>(found)));
        normal_ = point.normal;
    }

    /// Draws with one seed.
    Numbers draw(int samples, std::uint64_t seed) {
        weights_.weigh(pooled_, normal_, reliability_);
        weights_.shareSurprises(samples, 0, 0.4);
        std::vector<std::uint32_t> words(static_cast<std::size_t>(samples));
        fillSequence(Sequence::sobol, 0, seed, words);
        sampler_.draw(weights_, samples, words, seed);
        Numbers numbers;
        for (std::size_t i = 0; i < sampler_.size(); ++i) {
            const Region& region = sampler_.drawn(i).region;
            ++numbers[{region.level, region.cell}];
        }
        return numbers;
    }

    /// What the last draw left as the numbers of samples.
    Numbers expected(bool sharedOnly = false) const {
        Numbers numbers;
        for (std::size_t g = 0; g < weights_.size(); ++g)
            for (std::uint32_t i = 0; i < kBlockCells; ++i)
                if (weights_.spread(g)[i] > 0 && (!sharedOnly || weights_.shared(g)[i] != 0))
                    numbers[{weights_.group(g).level, weights_.group(g).firstCell + i}] =
                        static_cast<double>(weights_.spread(g)[i]);
        return numbers;
    }

private:
    static TriangleMesh makeMesh() {
        TriangleMesh mesh;
        test::addFloor(mesh, 0, -1, 1, -1, 1);
        test::addSphere(mesh, {0, 0.5f, 0}, 0.4f, 12);
        return mesh;
    }
    static BakeResult bakeOf(const Scene& scene) {
        BakeOptions options;
        options.spacing = 0.25;
        return bake(scene, options);
    }
    static Image makeMap() {
        Image map = test::noiseMap(64, 32, 5);
        const auto [x, y] = test::texelAt(64, 32, Vec3d(0.5, 0.8, 0.2).normalized());
        map.pixels[static_cast<std::size_t>(y * 64 + x)] = Rgb(1e5f, 1e5f, 1e5f);
        return map;
    }

    TriangleMesh mesh_ = makeMesh();
    Scene scene_{mesh_};
    test::TestCache cache_{bakeOf(scene_)};
    Environment environment_ = test::environmentOf(makeMap());
    std::array<ItemView, ShadowCache::kMaxItems> items_{};
    PooledVisibility pooled_{cache_.cache().header().tiers()};
    Vec3f normal_;
    Reliability reliability_;
    RegionWeights weights_{environment_, cache_.cache().header().tiers()};
    RegionSampler sampler_{environment_};
};

/// Too few for strata, and enough.
constexpr std::array<int, 4> kSamples{1, 3, 16, 64};

// The estimates and the exchange of surprises divide by these numbers.
TEST_F(RegionNumbers, AreOnAverageThoseLeftInTheWeights) {
    constexpr int kDraws = 4000;
    for (const int samples : kSamples) {
        Numbers sum;
        for (int k = 0; k < kDraws; ++k)
            for (const auto& [region, count] : draw(samples, static_cast<std::uint64_t>(k)))
                sum[region] += count;
        double all = 0;
        for (const auto& [region, mean] : expected()) {
            all += mean;
            const double chance = mean - std::floor(mean);
            // Six standard deviations of a number that is rounded up or down, and float rounding.
            EXPECT_NEAR(sum[region] / kDraws, mean,
                        6 * std::sqrt(chance * (1 - chance) / kDraws) + 3e-3);
            sum.erase(region);
        }
        EXPECT_TRUE(sum.empty()) << "a region without spread was drawn";
        EXPECT_NEAR(all, samples, 1e-3);
    }
}

TEST_F(RegionNumbers, AreRoundedUpOrDown) {
    for (const int samples : kSamples)
        for (std::uint64_t seed = 0; seed < 200; ++seed) {
            Numbers found = draw(samples, seed);
            for (const auto& [region, mean] : expected())
                EXPECT_LT(std::abs(found[region] - mean), 1);
        }
}

// With few samples one towards the sun is heavy, and so its region is shared; it is due several.
TEST_F(RegionNumbers, AreExactForSharedRegionsThatAreDueSeveral) {
    draw(6, 1);
    double most = 0;
    for (const auto& [region, mean] : expected(true)) most = std::max(most, mean);
    EXPECT_GE(most, 2);
    EXPECT_EQ(most, std::round(most));
}

}  // namespace
}  // namespace shadowcache
