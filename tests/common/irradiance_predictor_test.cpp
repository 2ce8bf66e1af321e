// The irradiance that the installed library predicts.

#include "common/predict/irradiance_predictor.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/predict/item_irradiance.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

constexpr double kRotation = 40;

/// A floor with a ball above it.
class Prediction : public testing::Test {
protected:
    test::TestCache cache_{bakeSet()};

    static RadianceImage constantMap(float radiance) {
        RadianceImage map;
        map.image = {1, 1, {Rgb(radiance)}};
        return map;
    }
    static std::vector<Vec3d> places() {
        std::vector<Vec3d> all;
        for (int x = -9; x <= 9; ++x)
            for (int z = -9; z <= 9; ++z) all.emplace_back(0.1 * x, 0, 0.1 * z);
        return all;
    }

private:
    static BakeResult bakeSet() {
        TriangleMesh mesh;
        test::addFloor(mesh, 0, -1, 1, -1, 1);
        test::addSphere(mesh, {0, 0.5f, 0}, 0.3f, 12);
        const Scene scene(mesh);
        BakeOptions options;
        options.spacing = 0.2;
        return bake(scene, options);
    }
};

TEST_F(Prediction, IsThatOfThePreview) {
    RadianceImage map;
    map.image = test::noiseMap(64, 32, 5);
    const IrradiancePredictor predictor(cache_.cache(), map, kRotation);
    IrradiancePredictor::Reader reader(predictor);

    const DirectionTiers tiers = cache_.cache().header().tiers();
    const Environment sky(map.image, kRotation, map.luminanceWeights);
    const Environment unturned(map.image, 0, map.luminanceWeights);
    const CachePreview preview(sky, tiers), another(unturned, tiers);
    ItemIrradiance expected(preview), control(another);
    ShadowCache::Reader items(cache_.cache());
    std::array<ItemView, ShadowCache::kMaxItems> out;
    int differ = 0;
    for (const Vec3d& place : places()) {
        const int found = items.lookUp(place, {0, 1, 0}, out);
        const std::span<const ItemView> here =
            std::span(out).first(static_cast<std::size_t>(found));
        const std::optional<Rgb> irradiance = reader.irradiance(place, {0, 1, 0});
        ASSERT_TRUE(irradiance.has_value());
        EXPECT_EQ(*irradiance, expected.mean(here, {0, 1, 0}));
        differ += *irradiance != control.mean(here, {0, 1, 0});
    }
    EXPECT_GT(differ, 300) << "control: the rotation matters";
}

TEST_F(Prediction, UnderAConstantSkyIsPiWhereAllIsVisible) {
    const IrradiancePredictor predictor(cache_.cache(), constantMap(2));
    IrradiancePredictor::Reader reader(predictor);
    const std::optional<Rgb> corner = reader.irradiance({0.95, 0, 0.95}, {0, 1, 0});
    const std::optional<Rgb> below = reader.irradiance({0, 0, 0}, {0, 1, 0});
    ASSERT_TRUE(corner && below);
    // The ball, 1.4 away, has 3 % of the solid angle there and stands low.
    EXPECT_NEAR(static_cast<double>(corner->x), 2 * kPi, 0.05 * kPi);
    // It covers angles up to asin(0.3 / 0.5) from the zenith: 36 % of the projected solid angle.
    EXPECT_NEAR(static_cast<double>(below->x), 2 * kPi * 0.64, 0.1 * kPi);
}

TEST_F(Prediction, IsEmptyWhereNothingWasBaked) {
    const IrradiancePredictor predictor(cache_.cache(), constantMap(1));
    IrradiancePredictor::Reader reader(predictor);
    EXPECT_TRUE(reader.irradiance({0.5, 0, 0.5}, {0, 1, 0}));
    EXPECT_FALSE(reader.irradiance({0.5, 7, 0.5}, {0, 1, 0}));
    EXPECT_FALSE(reader.irradiance({0.9, 0, 0.9}, {1, 0, 0})) << "no surface faces there";
}

TEST_F(Prediction, IsTheSameForEveryThread) {
    const IrradiancePredictor predictor(cache_.cache(), constantMap(1));
    const std::vector<Vec3d> all = places();
    std::vector<Rgb> one(all.size()), many(all.size());
    IrradiancePredictor::Reader reader(predictor);
    for (std::size_t i = 0; i < all.size(); ++i) one[i] = *reader.irradiance(all[i], {0, 1, 0});
    parallelFor(all.size(), 16, [&](const Chunk& chunk) {
        IrradiancePredictor::Reader own(predictor);
        for (std::size_t i = chunk.end; i-- > chunk.begin;)
            many[i] = *own.irradiance(all[i], {0, 1, 0});
    });
    EXPECT_TRUE(one == many);
}

TEST_F(Prediction, RefusesAnEmptyMap) {
    EXPECT_THROW(IrradiancePredictor(cache_.cache(), RadianceImage()), Error);
}

}  // namespace
}  // namespace shadowcache
