// The adaptive dome light: tiles of the map, what a pilot learns of their visibility, and that
// nothing it learns can change a mean.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "render/estimators/dome_cells.h"
#include "render/estimators/light_tiles.h"
#include "render/table/estimator_table.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

constexpr std::size_t kTiles = 128;

class Tiles : public testing::Test {
protected:
    const Environment environment_ = test::environmentOf(test::noiseMap(64, 32, 3));
    const LightTiles tiles_{environment_, kTiles};

    EnvironmentSample draw(std::size_t tile, std::uint64_t i) const {
        return environment_.sampleCell(tiles_[tile].level, tiles_[tile].cell,
                                       toUnit(hashWords(tile, i, 1)),
                                       static_cast<float>(toUnit(hashWords(tile, i, 2)) * 0.999),
                                       static_cast<float>(toUnit(hashWords(tile, i, 3)) * 0.999));
    }
};

TEST_F(Tiles, ShareTheLightOfTheMap) {
    EXPECT_LE(tiles_.size(), kTiles);
    EXPECT_GT(tiles_.size(), kTiles - 4);
    double sum = 0;
    for (const float light : tiles_.light()) sum += static_cast<double>(light);
    EXPECT_NEAR(sum / environment_.luminanceIntegral(), 1, 1e-5);
}

// Control: the cells of level 1, of which there are not many fewer, differ by more.
TEST_F(Tiles, HaveAboutTheSameLight) {
    double most = 0, mostOfLevel = 0;
    for (std::size_t t = 0; t < tiles_.size(); ++t)
        if (tiles_[t].level < Environment::kLevel)
            most = std::max(most, static_cast<double>(tiles_.light()[t]));
    for (std::uint32_t c = 0; c < cellCount(1); ++c)
        mostOfLevel = std::max(mostOfLevel, environment_.luminanceIntegral(1, c));
    const double mean = environment_.luminanceIntegral() / static_cast<double>(tiles_.size());
    EXPECT_LT(most, 2.5 * mean);
    EXPECT_GT(mostOfLevel, 2.5 * mean);
}

// What a direction is looked up as is what it was drawn from, or densities would not agree.
// Control: other tiles are told from it.
TEST_F(Tiles, AreFoundByTheirTexels) {
    std::size_t others = 0;
    for (std::size_t t = 0; t < tiles_.size(); ++t)
        for (std::uint64_t i = 0; i < 50; ++i) {
            EXPECT_EQ(tiles_.tileOf(draw(t, i).cell), t);
            others += tiles_.tileOf(draw((t + 1) % tiles_.size(), i).cell) == t ? 1u : 0u;
        }
    EXPECT_EQ(others, 0u);
}

TEST_F(Tiles, CosinesAreNearTheMeansAndPositiveAboveTheHorizon) {
    constexpr std::uint64_t kDraws = 400;
    std::vector<float> cosines(tiles_.size());
    for (std::uint32_t c = 0; c < cellCount(0); ++c) {
        const Vec3f normal(cellCenter(0, c));
        tiles_.cosines(normal, cosines);
        double difference = 0, control = 0;
        for (std::size_t t = 0; t < tiles_.size(); ++t) {
            double mean = 0;
            for (std::uint64_t i = 0; i < kDraws; ++i) {
                const float cosine = std::max(0.0f, draw(t, i).direction.dot(normal));
                mean += static_cast<double>(cosine) / kDraws;
            }
            if (mean > 0) {
                EXPECT_GT(cosines[t], 0) << t;
            }
            difference += std::abs(mean - static_cast<double>(cosines[t]));
            // Control: another tile's.
            control += std::abs(mean - static_cast<double>(cosines[(t + 40) % tiles_.size()]));
        }
        EXPECT_LT(difference / static_cast<double>(tiles_.size()), 0.02);
        EXPECT_GT(control / static_cast<double>(tiles_.size()), 0.1);
    }
}

// Floor and ceiling in the same pixels see different tiles. Control: if rays tell of no difference,
// none is learned.
TEST(DomeCells, KnowWhatIsVisibleFromWhere) {
    constexpr std::size_t kPlaces = 2000, kRays = 8, kTwo = 2;
    std::vector<ShadingPoint> places;
    std::vector<TileRay> rays, same;
    const std::vector<std::uint8_t> counts(kPlaces, kRays);
    for (std::size_t i = 0; i < kPlaces; ++i) {
        const float up = i % 2 == 0 ? 1.0f : -1.0f;
        ShadingPoint& point = places.emplace_back();
        point.place.position = Vec3d(toUnit(hashWords(i, 1)), 0, toUnit(hashWords(i, 2)));
        point.place.normal = Vec3f(0, up, 0);
        point.slot.filmX = static_cast<int>(100 * point.place.position.x);
        point.slot.filmY = static_cast<int>(100 * point.place.position.z);
        for (std::size_t k = 0; k < kRays; ++k) {
            const auto tile = static_cast<std::uint8_t>(k % kTwo);
            rays.push_back({tile, (tile == 0) == (up > 0)});
            same.push_back({tile, tile == 0});
        }
    }
    const DomeCells learned(places, rays, counts, kRays, kTwo);
    const DomeCells control(places, same, counts, kRays, kTwo);
    EXPECT_GT(learned.size(), 20u);
    for (const ShadingPoint& point : places) {
        const std::size_t seen = point.place.normal.y > 0 ? 0 : 1;
        EXPECT_GT(learned.visibility(point)[seen], 0.9f);
        EXPECT_LT(learned.visibility(point)[1 - seen], 0.1f);
        EXPECT_GT(control.visibility(point)[0], 0.9f);
    }
}

/// Floor beside a wall and a box, with a roof over a part.
TriangleMesh courtMesh() {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -2, 2, -2, 2);
    test::addBox(mesh, {-2, 0, -2}, {2, 1.6f, -1.8f});
    test::addBox(mesh, {0.2f, 0, -0.3f}, {0.7f, 0.8f, 0.4f});
    test::addFloor(mesh, 1.2f, -2, -0.8f, -1.8f, 2);
    return mesh;
}

/// Places in a rectangle of the floor, under what stands over it, seen from above as a film would.
std::vector<ShadingPoint> placesOnFloor(const Scene& scene, double x0, double z0, double width,
                                        double depth) {
    std::vector<ShadingPoint> places;
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const double x = width * toUnit(hashWords(i, 1)), z = depth * toUnit(hashWords(i, 2));
        const Vec3f from(static_cast<float>(x0 + x), 0.3f, static_cast<float>(z0 + z));
        ShadingPoint& point = places.emplace_back(test::pointAlong(scene, from, {0, -1, 0}));
        point.slot.seed = hashWords(i, 3);
        point.slot.filmX = static_cast<int>(100 * x);
        point.slot.filmY = static_cast<int>(100 * z);
    }
    return places;
}

class DomeLight : public testing::Test {
protected:
    const TriangleMesh mesh_ = courtMesh();
    const Scene scene_{mesh_};
    const Image map_ = test::noiseMap(16, 8, 3);
    const Environment environment_ = test::environmentOf(map_);
    const EstimatorContext context_{scene_, environment_, nullptr, {}};

    std::vector<ShadingPoint> placesBelowRoof() const {
        return placesOnFloor(scene_, -1.9, -1.7, 1.0, 3.5);
    }
};

double meanVariance(const Estimator& estimator, std::span<const ShadingPoint> points,
                    const EstimatorPlan* plan = nullptr) {
    double sum = 0;
    for (const ShadingPoint& point : points)
        sum += test::runEstimator(estimator, point, 16, 60, plan).sampleVariance(1);
    return sum / static_cast<double>(points.size());
}

/// A room with one open side, whose roof hides most of the map from all of the floor.
TriangleMesh roomMesh() {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -2, 2, -2, 2);
    test::addBox(mesh, {-2.1f, 1.2f, -2.1f}, {2.1f, 1.3f, 2});
    test::addBox(mesh, {-2.1f, 0, -2.1f}, {2.1f, 1.2f, -2});
    test::addBox(mesh, {-2.1f, 0, -2}, {-2, 1.2f, 2});
    test::addBox(mesh, {2, 0, -2}, {2.1f, 1.2f, 2});
    return mesh;
}

std::vector<ShadingPoint> placesInRoom(const Scene& room) {
    return placesOnFloor(room, -1.9, -1.9, 3.8, 3.5);
}

// Control: what was learned from rays that start below the floor, and meet nothing but its other
// side, does not help.
TEST(DomeLightInARoom, HasLessNoiseOnceItHasLearned) {
    const TriangleMesh mesh = roomMesh();
    const Scene room(mesh);
    const Environment environment = test::environmentOf(test::noiseMap(16, 8, 3));
    const std::vector<ShadingPoint> places = placesInRoom(room);
    const std::span<const ShadingPoint> some = std::span(places).first(60);
    const auto dome = findEstimator("dome").make({room, environment, nullptr, {}});
    const double before = meanVariance(*dome, some);
    const auto learned = dome->pilot()->plan(places, 16, 0);
    EXPECT_GT(learned->rays, 10000u);
    EXPECT_LT(meanVariance(*dome, some, learned.get()), 0.5 * before);

    std::vector<ShadingPoint> wrong = places;
    for (ShadingPoint& point : wrong) point.place.rayOrigin.y -= 0.01f;
    const auto misled = dome->pilot()->plan(wrong, 16, 0);
    EXPECT_GT(meanVariance(*dome, some, misled.get()), 0.8 * before);
}

// Each lie is told by rays that start elsewhere. Control: the same estimates must not agree with
// 10 % more.
TEST_F(DomeLight, IsUnbiasedWhateverItHasLearned) {
    struct Lie {
        std::string name;
        Vec3f offset;
        float normal;
    };
    const Lie lies[] = {
        {"NothingLearned", Vec3f(0, 0, 0), 0},   {"Truth", Vec3f(0, 0, 0), 1},
        {"AllOccluded", Vec3f(0, -0.01f, 0), 1}, {"AllVisible", Vec3f(0, 50, 0), 1},
        {"AnotherPlace", Vec3f(1.9f, 0, 0), 1},  {"BelowTheFloor", Vec3f(0, -1, 0), -1}};
    const Vec3f places[] = {{1.3f, 0.3f, 0.7f}, {0.1f, 0.3f, -1}, {-1.1f, 0.5f, 0.2f}};
    const double level = test::significance(2 * std::size(lies) * std::size(places));
    std::vector<Rgb> truths;
    for (const Vec3f& place : places)
        truths.push_back(
            test::tracedIrradiance(scene_, test::pointAlong(scene_, place, {0, -1, 0}), map_, 160));
    for (const Lie& lie : lies) {
        const auto dome = findEstimator("dome").make(context_);
        std::vector<ShadingPoint> told = placesBelowRoof();
        for (ShadingPoint& point : told) {
            point.place.rayOrigin += lie.offset;
            point.place.normal *= lie.normal;
        }
        const auto plan = lie.normal != 0 ? dome->pilot()->plan(told, 16, 0) : nullptr;
        for (std::size_t i = 0; i < std::size(places); ++i) {
            const Vec3f& place = places[i];
            const Rgb& truth = truths[i];
            const ShadingPoint point = test::pointAlong(scene_, place, {0, -1, 0});
            for (const auto& [samples, count] : {std::pair(1, 20000), std::pair(16, 3000)}) {
                const auto estimates = test::runEstimator(*dome, point, samples, count, plan.get());
                EXPECT_GT(test::agreementPValue(estimates, truth), level)
                    << lie.name << " at " << place << ", " << samples << " samples";
                if (samples > 1) {
                    EXPECT_LT(test::agreementPValue(estimates, truth * 1.1f), level)
                        << lie.name << " at " << place;
                }
            }
        }
    }
}

}  // namespace
}  // namespace shadowcache
