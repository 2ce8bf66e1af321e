// What other renderers draw at a place: directions by their density, and estimates of the true
// irradiance.

#include "render/samples/light_sampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <vector>

#include "common/base/hash.h"
#include "common/image/radiance_image.h"
#include "common/light/environment.h"
#include "common/math/direction_mesh.h"
#include "render/samples/sample_places.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

constexpr int kBinLevel = 2;
constexpr SampleAim kAims[] = {SampleAim::difference, SampleAim::light};

RadianceImage radianceOf(const Image& map) {
    RadianceImage result;
    result.image = map;
    return result;
}

/// A place beside a slab that hides a part of a map.
class LightAtAPlace : public testing::Test {
protected:
    LightAtAPlace() { aim(SampleAim::difference); }

    /// Goes to the place to draw samples of a kind.
    void aim(SampleAim aim) {
        reader_.moveTo(Vec3d(point_.place.position), point_.place.normal, aim);
    }

    /// Sample number k; its place in a texel is at least `border` from the texel's border.
    LightSample draw(std::uint64_t k, float border = 0) const {
        const auto inside = [&](std::uint64_t axis) {
            const auto word = static_cast<std::uint32_t>(hashWords(k, axis) >> 32);
            return border + (1 - 2 * border) * toUnitFloat(word);
        };
        return reader_.sample(toUnit(hashWords(k, 1)), inside(2), inside(3));
    }

    /// Radiance times cosine that a ray finds.
    double lightAlong(const LightSample& s) const {
        const float cosine = s.direction.dot(point_.place.normal);
        if (cosine <= 0 || !world_.scene.isFree(point_.place.rayOrigin, s.direction * 1000.0f))
            return 0;
        return static_cast<double>(cosine * s.radiance.y);
    }

    std::size_t binOf(const Vec3f& direction) const {
        return ancestorCell(world_.environment.lookUp(direction).cell, Environment::kLevel,
                            kBinLevel);
    }

    /// Integrals of `value` over bins of the sphere, as sums over the texels of the map.
    std::vector<double> integrals(const std::function<double(const LightSample&)>& value) const {
        std::vector<double> sums(cellCount(kBinLevel));
        for (std::size_t i = 0; i < world_.environment.texelCount(); ++i) {
            const Environment::Texel texel = world_.environment.texel(i);
            sums[binOf(texel.center)] +=
                value(reader_.along(texel.center)) * static_cast<double>(texel.solidAngle);
        }
        return sums;
    }

    const Image map_ = test::noiseMap(64, 32, 7);
    const test::World world_{test::slabMesh(), map_};
    const ShadingPoint point_ = world_.below();
    const LightSampler sampler_{world_.cache.cache(), radianceOf(map_)};
    LightSampler::Reader reader_{sampler_};
};

double sumOf(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

// With its control: a density that is tilted by four per cent is rejected.
TEST_F(LightAtAPlace, DirectionsFollowTheDensity) {
    constexpr std::uint64_t kDraws = 500000;
    for (const SampleAim of : kAims) {
        aim(of);
        std::vector<double> counts(cellCount(kBinLevel));
        for (std::uint64_t k = 0; k < kDraws; ++k) ++counts[binOf(draw(k).direction)];
        const auto pValue = [&](double tilt) {
            std::vector<double> wanted = integrals([&](const LightSample& s) {
                return s.pdf * (1 + tilt * static_cast<double>(s.direction.x + s.direction.z));
            });
            const double scale = static_cast<double>(kDraws) / sumOf(wanted);
            for (double& count : wanted) count *= scale;
            return test::chiSquaredPValue(counts, wanted);
        };
        EXPECT_GT(pValue(0), test::significance(2));
        EXPECT_LT(pValue(0.04), test::significance(2));
    }
}

// With its controls: means that are five per cent off, two with the control variate.
TEST_F(LightAtAPlace, EstimatesHaveTheMeanOfTheIrradiance) {
    constexpr std::uint64_t kEstimates = 4000, kSamples = 16;
    const double level = test::significance(6);
    const auto expectMean = [&](const std::vector<double>& estimates, double mean, double wrong) {
        EXPECT_GT(test::meanPValue(estimates, mean), level);
        EXPECT_LT(test::meanPValue(estimates, (1 + wrong) * mean), level);
    };
    const auto truth =
        static_cast<double>(test::tracedIrradiance(world_.scene, point_, map_, 40).y);
    for (const SampleAim of : kAims) {
        aim(of);
        const auto integral = static_cast<double>(reader_.integral().y);
        std::vector<double> without, controls, with;
        for (std::uint64_t e = 0; e < kEstimates; ++e) {
            double light = 0, control = 0;
            for (std::uint64_t k = 0; k < kSamples; ++k) {
                const LightSample s = draw(e * kSamples + k);
                light += lightAlong(s) / s.pdf / kSamples;
                control += static_cast<double>(s.control.y) / s.pdf / kSamples;
            }
            without.push_back(light);
            controls.push_back(control);
            with.push_back(integral + light - control);
        }
        expectMean(without, truth, 0.05);
        expectMean(controls, integral, 0.05);
        expectMean(with, truth, 0.02);
    }
}

TEST_F(LightAtAPlace, DensityIntegratesToOne) {
    EXPECT_NEAR(sumOf(integrals([](const LightSample& s) { return s.pdf; })), 1, 1e-4);
}

TEST_F(LightAtAPlace, ASampleIsWhatIsAlongItsDirection) {
    for (std::uint64_t k = 0; k < 5000; ++k) {
        // At a border the direction may be rounded into the next texel.
        const LightSample drawn = draw(k, 0.05f);
        const LightSample along = reader_.along(drawn.direction);
        ASSERT_GT(drawn.pdf, 0);
        EXPECT_NEAR(reader_.pdf(drawn.direction) / drawn.pdf, 1, 1e-4);
        EXPECT_EQ(along.radiance, drawn.radiance);
        EXPECT_NEAR(along.control.y, drawn.control.y, 1e-5f * drawn.radiance.y);
    }
}

TEST_F(LightAtAPlace, NothingIsMissed) {
    for (std::size_t i = 0; i < world_.environment.texelCount(); ++i) {
        const LightSample s = reader_.along(world_.environment.texel(i).center);
        if (lightAlong(s) > 0) {
            EXPECT_GT(s.pdf, 0);
        }
    }
    EXPECT_EQ(reader_.pdf(Vec3f(0, -1, 0)), 0);
}

// What the slab hides, as the bake found out, gets fewer samples than its light.
TEST_F(LightAtAPlace, CountsAreFollowed) {
    aim(SampleAim::light);
    double hiddenLight = 0, all = 0;
    const auto share = [&](const LightSample& s) {
        const auto light = static_cast<double>(s.radiance.y) *
                           std::max(0.0, static_cast<double>(s.direction.dot(point_.place.normal)));
        all += light;
        if (lightAlong(s) > 0) return 0.0;
        hiddenLight += light;
        return s.pdf;
    };
    const double hidden = sumOf(integrals(share));
    EXPECT_GT(hiddenLight / all, 0.1);
    EXPECT_LT(hidden, 0.7 * hiddenLight / all);
}

// Light and cosine alone are followed where the cache holds nothing.
TEST_F(LightAtAPlace, PlacesWithoutItemsAreUnbiased) {
    EXPECT_FALSE(reader_.moveTo(Vec3d(point_.place.position) + Vec3d(0, 40, 0), {0, 1, 0}));
    const double truth = sumOf(integrals([](const LightSample& s) {
        return static_cast<double>(s.radiance.y * std::max(0.0f, s.direction.y));
    }));
    double sum = static_cast<double>(reader_.integral().y);
    constexpr std::uint64_t kDraws = 100000;
    for (std::uint64_t k = 0; k < kDraws; ++k) {
        const LightSample s = draw(k);
        const float found = s.radiance.y * std::max(0.0f, s.direction.y) - s.control.y;
        sum += static_cast<double>(found) / s.pdf / kDraws;
    }
    EXPECT_NEAR(sum / truth, 1, 0.01);
}

TEST_F(LightAtAPlace, ManyPlacesAreTheSameAsEach) {
    constexpr std::size_t kSamples = 8;
    const double none = std::numeric_limits<double>::quiet_NaN();
    const Vec3d at(point_.place.position);
    const std::vector<Vec3d> positions{at, {none, 0, 0}, at + Vec3d(0.3, 0, 0.1)};
    const std::vector<Vec3d> normals(3, {0, 2, 0});
    std::vector<LightSample> samples(positions.size() * kSamples);
    std::vector<Rgb> integrals(positions.size());
    samplePlaces(sampler_, {positions, normals}, SampleAim::difference, {}, samples, integrals);
    EXPECT_TRUE(std::isnan(integrals[1].x));
    EXPECT_EQ(samples[kSamples].pdf, 0);
    for (const std::size_t i : {0u, 2u}) {
        reader_.moveTo(positions[i], {0, 1, 0});
        EXPECT_EQ(integrals[i], reader_.integral());
        for (std::size_t k = i * kSamples; k < (i + 1) * kSamples; ++k)
            EXPECT_NEAR(reader_.pdf(samples[k].direction) / samples[k].pdf, 1, 1e-3);
    }
    EXPECT_NE(samples[0].direction, samples[2 * kSamples].direction);

    const std::vector<Vec3d> directions{{0, 3, 0}, {0, 1, 0}, {0, 0, 0}};
    std::vector<LightSample> along(3);
    readAlong(sampler_, {positions, normals}, SampleAim::difference, directions, along);
    reader_.moveTo(positions[0], {0, 1, 0});
    EXPECT_EQ(along[0].pdf, reader_.pdf({0, 1, 0}));
    EXPECT_TRUE(std::isnan(along[1].pdf));
    EXPECT_TRUE(std::isnan(along[2].pdf));
}

TEST(LightSampler, ABlackSkyHasNoSamples) {
    const test::World world(test::slabMesh(), test::constantMap(Rgb(0.0f)));
    const LightSampler sampler(world.cache.cache(), world.environment);
    LightSampler::Reader reader(sampler);
    const ShadingPoint point = world.below();
    reader.moveTo(Vec3d(point.place.position), point.place.normal);
    EXPECT_TRUE(reader.empty());
    EXPECT_EQ(reader.integral(), Rgb(0.0f));
    EXPECT_EQ(reader.pdf({0, 1, 0}), 0);
}

}  // namespace
}  // namespace shadowcache
