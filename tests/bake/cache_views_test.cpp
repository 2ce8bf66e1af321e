// Views of a cache: its regions, the light they foresee, a place's sky, the grids for volume tools.

#include <gtest/gtest.h>

#include <cmath>

#include "bake/inspect/grid_export.h"
#include "bake/inspect/sky_light.h"
#include "bake/inspect/sky_view.h"
#include "common/cache/volume_grids.h"
#include "common/image/exr.h"
#include "tests/support/foreign_vdb.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

using test::addBox;
using test::addFloor;

constexpr double kSpacing = 0.5;

/// A floor and a block beside its middle, the block's corners [16, end) of the triangles.
TriangleMesh floorAndBlock() {
    TriangleMesh mesh;
    addFloor(mesh, 0, -4, 4, -4, 4);
    addBox(mesh, {1.25f, 0.5f, -3}, {2.25f, 3.5f, 3});
    return mesh;
}

BakeResult baked(const TriangleMesh& mesh, int level = 5, bool adaptive = true, int rays = 16) {
    const Scene scene(mesh);
    BakeOptions options;
    options.spacing = kSpacing;
    options.level = level;
    options.adaptive = adaptive;
    options.rays = rays;
    return bake(scene, options);
}

/// The item of a voxel and a side.
std::size_t itemAt(const CacheItems& items, const Vec3i& voxel, int side) {
    for (std::size_t i = 0; i < items.size(); ++i)
        if (items.voxel[i] == voxel && items.patch[i] == PatchCode{side}.packed()) return i;
    ADD_FAILURE() << "no such item";
    return 0;
}
constexpr int kUp = 2;

TEST(ItemRegions, TileWhatWasCounted) {
    for (const int level : {0, 1, 2, 5})
        for (const bool adaptive : {true, false}) {
            SCOPED_TRACE(level);
            const BakeResult result = baked(floorAndBlock(), level, adaptive, 8);
            ItemRegions regions(result.header.tiers());
            regions.use(result.items, itemAt(result.items, {0, 0, 0}, kUp));
            std::vector<int> covered(cellCount(kMaxCacheLevel));
            for (const CountedRegion& r : regions.finest()) {
                EXPECT_LE(r.n, r.d);
                EXPECT_GT(r.d, 0u);
                EXPECT_GT(r.posterior, 0);
                EXPECT_LT(r.posterior, 1);
                const std::uint32_t count = 1u << (2 * (kMaxCacheLevel - r.level));
                for (std::uint32_t k = 0; k < count; ++k) ++covered[r.cell * count + k];
                const CountedRegion same = regions.along(r.cell * count + count / 2);
                EXPECT_EQ(same.level, r.level);
                EXPECT_EQ(same.cell, r.cell);
                EXPECT_EQ(same.n, r.n);
                EXPECT_EQ(same.posterior, r.posterior);
            }
            for (std::uint32_t cell = 0; cell < covered.size(); ++cell) {
                EXPECT_EQ(covered[cell], regions.along(cell).d > 0 ? 1 : 0);
                // The sky above the floor is known; what is wholly below it is not.
                const double height = cellCenter(kMaxCacheLevel, cell).y;
                if (std::abs(height + 0.3) > 0.4) {
                    EXPECT_EQ(covered[cell], height > 0 ? 1 : 0) << height;
                }
            }
        }
}

TEST(SkyLight, OfAnOpenFloorIsThatOfTheWholeSky) {
    TriangleMesh mesh;
    addFloor(mesh, 0, -4, 4, -4, 4);
    const BakeResult result = baked(mesh);
    ItemRegions regions(result.header.tiers());
    const std::size_t item = itemAt(result.items, {0, 0, 0}, kUp);
    regions.use(result.items, item);
    const auto sky = test::environmentOf(test::constantMap({1, 2, 3}));
    const SkyLight light = skyLight(regions.finest(), result.items.normal[item], sky);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(static_cast<double>(light.seen[c]), (c + 1) * kPi, 0.01 * (c + 1));
        EXPECT_EQ(light.seen[c], light.unshadowed[c]);
    }
}

TEST(SkyLight, LosesWhatABlockHides) {
    const TriangleMesh mesh = floorAndBlock();
    const BakeResult result = baked(mesh);
    const std::size_t item = itemAt(result.items, {0, 0, 0}, kUp);
    ItemRegions regions(result.header.tiers());
    regions.use(result.items, item);
    const SkyLight light = skyLight(regions.finest(), result.items.normal[item],
                                    test::environmentOf(test::constantMap(Rgb(1.0f))));
    const Scene scene(mesh);
    const double hidden = test::hiddenByConvex(mesh, 2, mesh.triangles.size(),
                                               test::pointAlong(scene, {0, 0.4f, 0}, {0, -1, 0}));
    EXPECT_GT(hidden, 0.3);
    EXPECT_NEAR(static_cast<double>(light.unshadowed.x - light.seen.x), hidden, 0.1 * hidden);
}

TEST(SkyView, SeesTheBlockWhereItStands) {
    const test::TestCache cache(baked(floorAndBlock()));
    const SkyView view(cache.cache(), {0, 0, 0}, {0, 1, 0});
    EXPECT_GE(view.weights().size(), 1u);
    EXPECT_LT(view.look(Vec3d(1, 1, 0).normalized()).visible, 0.05);
    EXPECT_GT(view.look(Vec3d(-1, 1, 0).normalized()).visible, 0.95);
    EXPECT_GT(view.look({0, 1, 0}).visible, 0.95);
    const SkyView::Figures f = view.figures();
    EXPECT_GT(f.known, 0.95);
    EXPECT_GT(f.pure, 0.5);
    EXPECT_GT(f.visible, 0.6);
    const TriangleMesh mesh = floorAndBlock();
    const Scene scene(mesh);
    const double hidden = test::hiddenByConvex(mesh, 2, mesh.triangles.size(),
                                               test::pointAlong(scene, {0, 0.4f, 0}, {0, -1, 0}));
    EXPECT_NEAR(f.visibleCosine, 1 - hidden / kPi, 0.03);
    EXPECT_LT(f.bentNormal.x, -0.05);
    EXPECT_NEAR(f.bentNormal.z, 0, 0.05);

    // +X is left of the middle, +Y at the top: the block is a dark spot there.
    const Image picture = view.picture(64);
    ASSERT_EQ(picture.height, 32);
    const auto pixel = [&](int x, int y) {
        return picture.pixels[static_cast<std::size_t>(y * 64 + x)];
    };
    EXPECT_LT(luminance(pixel(16, 10)), 0.05f);
    EXPECT_GT(luminance(pixel(48, 10)), 0.5f);
    EXPECT_EQ(pixel(16, 25), pixel(48, 25)) << "below the horizon";
}

TEST(SkyView, KnowsNothingOffTheSurfaces) {
    const test::TestCache cache(baked(floorAndBlock()));
    const SkyView view(cache.cache(), {0, 20, 0}, {0, 1, 0});
    EXPECT_TRUE(view.weights().empty());
    EXPECT_EQ(view.look({0, 1, 0}).counted, 0);
    EXPECT_EQ(view.figures().known, 0);
    EXPECT_EQ(view.picture(8).pixels.size(), 32u);
}

TEST(Grids, AreTypedAndTrue) {
    const BakeResult result = baked(floorAndBlock());
    const test::TemporaryFolder folder;
    const auto path = folder.path() / "grids.vdb";
    const auto map = folder.path() / "sky.exr", cacheFile = folder.path() / "cache.vdb";
    writeCache(cacheFile, result.header, result.items);
    const std::vector<float> one(8, 1.0f);
    writeExr(map, 4, 2, {{"R", one}, {"G", one}, {"B", one}}, {}, PixelType::full);
    std::vector<GridRequest> requests;
    for (const std::string& spec :
         {std::string("openness"), std::string("density:direction=2,2,0"),
          std::string("mean-direction"), std::string("confidence"), std::string("surface"),
          "env=" + map.string(), "irradiance=" + map.string(),
          "bounced-irradiance=" + map.string()})
        requests.push_back(parseGridRequest(spec));
    exportGrids(requests, 0, result.header, result.items, cacheFile, path);

    std::map<std::string, test::StockVolume> volumes;
    for (const auto& volume : test::readVolumesWithStockOpenVdb(path)) {
        volumes[volume.name] = volume;
        EXPECT_EQ(volume.voxelSize, kSpacing);
        EXPECT_EQ(volume.values.size(), findVoxels(result.items).voxels.size());
    }
    ASSERT_EQ(volumes.size(), 8u);
    EXPECT_EQ((volumes["surface"].values[{0, 0, 0}][0]), 1);
    for (const char* name : {"openness", "density", "confidence", "surface", "env_visibility"}) {
        EXPECT_EQ(volumes[name].gridClass, "fog volume") << name;
        EXPECT_EQ(volumes[name].valueType, "float") << name;
        for (const auto& [voxel, value] : volumes[name].values) {
            EXPECT_GE(value[0], 0) << name;
            EXPECT_LE(value[0], 1) << name;
        }
    }
    EXPECT_EQ(volumes["open_direction"].valueType, "vec3s");
    EXPECT_EQ(volumes["open_direction"].vectorType, "contravariant relative");
    EXPECT_EQ(volumes["irradiance"].valueType, "vec3s");
    EXPECT_EQ(volumes["irradiance"].vectorType, "invariant");

    // Toward (1, 1, 0) the floor left of the block is dark, and open far from it.
    EXPECT_LT((volumes["density"].values[{0, 0, 0}][0]), 0.1);
    EXPECT_GT((volumes["density"].values[{-6, 0, 0}][0]), 0.9);
    // The roof of the block sees all the sky.
    EXPECT_GT((volumes["env_visibility"].values[{3, 7, 0}][0]), 0.95);
    EXPECT_GT((volumes["confidence"].values[{-6, 0, 0}][0]), 0.8);
    EXPECT_GT((volumes["openness"].values[{3, 7, 0}][0]), 0.95);
    EXPECT_NEAR((volumes["irradiance"].values[{-7, 0, 0}][0]), kPi, 0.3);
    // Beside the block the floor has light from its wall; far from it, none.
    double direct = 0, bounced = 0;
    for (const auto& [voxel, value] : volumes["irradiance"].values) {
        direct += static_cast<double>(value[0]);
        bounced += static_cast<double>(volumes["bounced_irradiance"].values[voxel][0]);
    }
    EXPECT_GT(bounced, 1.005 * direct);
    EXPECT_LT(bounced, 1.5 * direct);
    const auto& toward = volumes["open_direction"].values[{3, 7, 0}];
    EXPECT_NEAR(std::hypot(toward[0], toward[1], toward[2]), 1, 2e-3);
    EXPECT_GT(toward[1], 0.9);
}

TEST(Grids, OfTheCacheFileAreTyped) {
    const BakeResult result = baked(floorAndBlock());
    const test::TemporaryFolder folder;
    writeCache(folder.path() / "cache.vdb", result.header, result.items);
    std::map<std::string, test::StockVolume> volumes;
    for (const auto& volume : test::readVolumesWithStockOpenVdb(folder.path() / "cache.vdb"))
        volumes[volume.name] = volume;
    EXPECT_EQ(volumes.at("openness").gridClass, "fog volume");
    EXPECT_EQ(volumes.at("open_direction").vectorType, "contravariant relative");
    // The mean of the roof, which is open, and of its closed underside.
    EXPECT_NEAR((volumes["openness"].values[{3, 7, 0}][0]), 0.5, 0.1);
}

TEST(Grids, RefuseWhatTheyDoNotKnow) {
    test::expectError([] { parseGridRequest("opennes"); }, "opennes", "did you mean openness?");
    test::expectError([] { parseGridRequest("a:b:c"); }, "a:b:c", "expected [NAME:]KIND");
    const BakeResult result = baked(floorAndBlock(), 0);
    const test::TemporaryFolder folder;
    const auto path = folder.path() / "grids.vdb";
    const auto refuses = [&](const std::vector<std::string>& specs, const std::string& thing,
                             const std::string& cause) {
        std::vector<GridRequest> requests;
        requests.reserve(specs.size());
        for (const std::string& spec : specs) requests.push_back(parseGridRequest(spec));
        test::expectError([&] { exportGrids(requests, 0, result.header, result.items, {}, path); },
                          thing, cause);
        EXPECT_FALSE(std::filesystem::exists(path));
    };
    for (const std::string wrong :
         {"direction", "direction=", "direction=0,0,0", "direction=1,2", "direction=nan,0,1"})
        refuses({wrong}, "direction", "expected a direction");
    refuses({"env"}, "env", "expected a map");
    refuses({"env=missing.exr"}, "missing.exr", "no such file");
    refuses({"openness", "openness"}, "openness", "two grids");
}

}  // namespace
}  // namespace shadowcache
