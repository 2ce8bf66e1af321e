// Which items the rays of an item met: as the bake keeps it, as readers find it again, whatever
// threads, shards and shots the bake had.

#include "common/cache/transport.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "bake/core/hit_tracer.h"
#include "bake/core/merge.h"
#include "common/base/parallel.h"
#include "common/cache/hit_code.h"
#include "common/predict/bounce_solve.h"
#include "tests/support/small_bake.h"
#include "tests/support/statistics.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache {
namespace {

namespace fs = std::filesystem;
using test::bakeSmall;
using test::smallOptions;

TEST(HitCodes, HoldTheSideAndTheDistance) {
    for (int side = 0; side < kSides; ++side) {
        double distance = 0;
        while (distance < 2e6) {
            const std::uint16_t code = HitCode::of(distance, side);
            ASSERT_TRUE(HitCode::isSurface(code) && HitCode::isValid(code));
            EXPECT_EQ(HitCode::side(code), side);
            // Half a step: ln 2 / 570 of the distance and 4 spacings more.
            EXPECT_NEAR(HitCode::distance(code), distance, 0.5 * 0.00123 * (distance + 4));
            distance = distance * 1.03 + 0.001;
        }
    }
    EXPECT_EQ(HitCode::distance(HitCode::of(-1, 0)), 0);
    EXPECT_TRUE(HitCode::isValid(HitCode::of(1e30, kSides - 1)));
    EXPECT_FALSE(HitCode::isSurface(HitCode::kSky) || HitCode::isSurface(HitCode::kUnknown));
    // Control.
    EXPECT_FALSE(HitCode::isValid(65534) || HitCode::isValid(65535));
}

/// p-value that the heights of the rays of many items above their surface are those of a cosine.
double cosinePValue(double power) {
    constexpr int kBins = 16, kItems = 32768;
    std::vector<double> observed(kBins);
    const Vec3f normal = Vec3f(1, -2, 0.5f).normalized();
    for (int i = 0; i < kItems; ++i) {
        // One ray an item: those of one item are stratified.
        const HitRays rays({i % 16, i / 16 % 16, i / 256}, 0, normal, kHitRays);
        const Vec3f direction = rays.direction(i % kHitRays);
        EXPECT_NEAR(direction.length(), 1, 1e-5);
        const double u = std::pow(std::max(0.0, static_cast<double>(direction.dot(normal))), power);
        ++observed[static_cast<std::size_t>(std::min(u * kBins, kBins - 1.0))];
    }
    const std::vector<double> expected(kBins, double{kItems} / kBins);
    return test::chiSquaredPValue(observed, expected);
}

TEST(HitRays, AreDistributedAsTheCosine) {
    const double level = test::significance(1);
    EXPECT_GT(cosinePValue(2), level);
    EXPECT_LT(cosinePValue(1.8), level) << "control";
}

/// An open cache of the small set, and what its rays met.
struct Met {
    test::TestCache cache;
    ItemTable items;
    Transport transport;

    explicit Met(const BakeResult& baked)
        : cache(baked), items(cache.cache()), transport(*readTransport(cache.cache(), items)) {}

    std::span<const std::uint32_t> of(std::size_t item) const {
        const auto rays = static_cast<std::size_t>(transport.raysPerItem);
        return std::span(transport.hit).subspan(item * rays, rays);
    }
};

/// Share of the hits on items that a ray from the middle of the item that traced them meets as
/// well, up to 1.5 spacings beside the item that is `shifted` behind the right one.
double shareConfirmed(const TriangleMesh& mesh, const Met& met, std::uint32_t shifted) {
    const Scene scene(mesh);
    double confirmed = 0, all = 0;
    for (std::uint32_t i = 0; i < met.items.size(); ++i) {
        const Vec3f normal = met.items.normal(i);
        const Vec3f from(met.items.position(i) - mesh.origin + Vec3d(normal) * 1e-4);
        const HitRays rays(met.items.item(i).voxel, met.items.item(i).patch, normal, kHitRays);
        for (int k = 0; k < kHitRays; ++k) {
            const std::uint32_t hit = met.of(i)[static_cast<std::size_t>(k)];
            if (hit == kSky || hit == kNoItem) continue;
            const auto other = static_cast<std::uint32_t>((hit + shifted) % met.items.size());
            const Hit found = scene.intersect(from, rays.direction(k));
            const Vec3d way = Vec3d(found.position) + mesh.origin - met.items.position(other);
            ++all;
            confirmed += found.found && way.length() < 1.5 * met.items.spacing();
        }
    }
    EXPECT_GT(all, 100);
    return confirmed / all;
}

TEST(Transport, MeetsTheItemsThatARayMeets) {
    const TriangleMesh mesh = test::smallMesh();
    const BakeResult baked = bakeSmall(smallOptions());
    const Met met(baked);
    EXPECT_EQ(met.transport.raysPerItem, kHitRays);
    EXPECT_EQ(met.transport.hit.size(), met.items.size() * kHitRays);
    const auto stuck = std::ranges::count_if(
        baked.items.hits, [](std::uint16_t code) { return !HitCode::isFree(code); });
    EXPECT_EQ(std::ranges::count(met.transport.hit, kNoItem), stuck);
    EXPECT_EQ(std::ranges::count(baked.items.hits, HitCode::kUnknown), 0);
    EXPECT_GT(shareConfirmed(mesh, met, 0), 0.93);
    EXPECT_LT(shareConfirmed(mesh, met, 7), 0.5) << "control";
    // Nothing meets itself, but for what is bent.
    for (std::uint32_t i = 0; i < met.items.size(); ++i)
        EXPECT_EQ(std::ranges::count(met.of(i), i), 0) << i;
}

/// Hits on items of rays from the floor up to the underside of a roof.
std::ptrdiff_t itemsMetUnderRoof(bool doubleSided) {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -0.5f, 0.5f, -0.5f, 0.5f);
    test::addFloor(mesh, 0.5f, -4, 4, -4, 4);
    Material material;
    material.doubleSided = doubleSided;
    mesh.materials.push_back(material);
    mesh.parts.push_back({0, static_cast<std::uint32_t>(mesh.triangles.size()), 0});
    const Scene scene(mesh);
    const Met met(bake(scene, smallOptions()));
    std::ptrdiff_t found = 0;
    for (std::uint32_t i = 0; i < met.items.size(); ++i)
        if (met.items.position(i).y < 0.1 && met.items.normal(i).y > 0.9f)
            found += std::ranges::count_if(
                met.of(i), [&](std::uint32_t hit) { return hit < met.items.size(); });
    return found;
}

TEST(Transport, StopsAtBacksThatReflectNothing) {
    EXPECT_EQ(itemsMetUnderRoof(false), 0);
    EXPECT_GT(itemsMetUnderRoof(true), 100) << "control";
}

/// By item: rays that reach the sky, less what the cosine-weighted counts times `factor` say.
std::vector<double> skyDifferences(const BakeResult& baked, double factor) {
    const std::size_t cells = baked.header.tiers().baseCells();
    std::vector<double> differences;
    for (std::size_t i = 0; i < baked.items.size(); ++i) {
        double visible = 0, all = 0;
        for (std::size_t c = 0; c < cells; ++c) {
            const double d = baked.items.d[i * cells + c], n = baked.items.n[i * cells + c];
            const double cosine = Vec3d(baked.items.normal[i])
                                      .dot(cellCenter(baked.header.tiers().baseLevel(),
                                                      static_cast<std::uint32_t>(c)));
            if (d == 0 || cosine <= 0) continue;
            visible += cosine * n / d;
            all += cosine;
        }
        const auto first = baked.items.hits.begin() + static_cast<std::ptrdiff_t>(i * kHitRays);
        const auto sky = static_cast<double>(std::count(first, first + kHitRays, HitCode::kSky));
        differences.push_back(sky / kHitRays - factor * visible / all);
    }
    return differences;
}

TEST(Transport, ReachesTheSkyAsOftenAsTheCounts) {
    BakeOptions options = smallOptions();
    options.spacing = 0.1;
    options.adaptive = false;
    options.level = 3;
    const BakeResult baked = bakeSmall(options);
    const double level = test::significance(1);
    EXPECT_GT(test::meanPValue(skyDifferences(baked, 1), 0), level);
    EXPECT_LT(test::meanPValue(skyDifferences(baked, 1.03), 0), level) << "control";
}

TEST(Transport, HasTheSameBitsForAnyNumberOfThreads) {
    setThreadCount(1);
    const BakeResult one = bakeSmall(smallOptions());
    const Met first(one);
    setThreadCount(3);
    const BakeResult three = bakeSmall(smallOptions());
    const Met second(three);
    setThreadCount(0);
    EXPECT_EQ(one.items.hits, three.items.hits);
    EXPECT_EQ(first.transport.hit, second.transport.hit);
    EXPECT_NE(bakeSmall(smallOptions(2)).items.hits, one.items.hits) << "control";
}

TEST(Transport, OfShardsIsThatOfTheWholeOnceMerged) {
    const test::TemporaryFolder folder;
    std::vector<fs::path> paths;
    for (int shard = 0; shard < 3; ++shard) {
        BakeOptions options = smallOptions();
        options.shard = shard;
        options.shards = 3;
        const BakeResult part = bakeSmall(options);
        paths.push_back(folder.path() / fmt::format("{}.vdb", shard));
        writeCache(paths.back(), part.header, part.items);
        // Control: a part does not hold all that its rays met.
        EXPECT_GT(std::ranges::count(Met(part).transport.hit, kNoItem), 0);
    }
    BakeResult merged;
    merged.items = mergeCaches(paths, merged.header);
    const BakeResult whole = bakeSmall(smallOptions());
    EXPECT_EQ(merged.items.hits, whole.items.hits);
    EXPECT_EQ(Met(merged).transport.hit, Met(whole).transport.hit);
}

TEST(Transport, OfTwoSeedsIsThatOfTheFirst) {
    const test::TemporaryFolder folder;
    const BakeResult a = bakeSmall(smallOptions(1)), b = bakeSmall(smallOptions(2));
    const std::vector paths{folder.path() / "a.vdb", folder.path() / "b.vdb"};
    writeCache(paths[0], a.header, a.items);
    writeCache(paths[1], b.header, b.items);
    CacheHeader header;
    EXPECT_EQ(mergeCaches(paths, header).hits, a.items.hits);
    EXPECT_EQ(header.hits, kHitRays);
}

TEST(Transport, CanBeLeftOut) {
    BakeOptions options = smallOptions();
    options.transport = false;
    const BakeResult with = bakeSmall(smallOptions()), without = bakeSmall(options);
    EXPECT_EQ(without.header.hits, 0);
    EXPECT_TRUE(without.items.hits.empty());
    EXPECT_EQ(without.items.n, with.items.n);
    EXPECT_EQ(without.items.d, with.items.d);
    EXPECT_LT(without.rays, with.rays);
    const test::TestCache cache(without);
    EXPECT_FALSE(readTransport(cache.cache(), ItemTable(cache.cache())));

    const test::TemporaryFolder folder;
    const std::vector paths{folder.path() / "with.vdb", folder.path() / "without.vdb"};
    writeCache(paths[0], with.header, with.items);
    writeCache(paths[1], without.header, without.items);
    CacheHeader header;
    test::expectError([&] { mergeCaches(paths, header); }, "without.vdb",
                      "hits of an item 0, expected 16");
}

TEST(Transport, IsReadPageByPageAsWell) {
    const test::TemporaryFolder folder;
    const fs::path path = folder.path() / "cache.vdb";
    const BakeResult baked = bakeSmall(smallOptions());
    writeCache(path, baked.header, baked.items);
    const Met whole(baked);
    const ShadowCache paged(path, std::uint64_t{1} << 20);
    const ItemTable items(paged);
    EXPECT_EQ(readTransport(paged, items)->hit, whole.transport.hit);
    for (std::uint32_t i = 0; i < items.size(); ++i)
        EXPECT_EQ(items.position(i), whole.items.position(i));
}

TEST(Transport, WithHitsThatCannotBeIsRefused) {
    const test::TemporaryFolder folder;
    const fs::path path = folder.path() / "hits.vdb";
    BakeResult baked = bakeSmall(smallOptions());
    for (const bool whole : {false, true}) {
        baked.items.hits.back() = static_cast<std::uint16_t>(whole ? HitCode::kUnknown : 65535);
        writeCache(path, baked.header, baked.items);
        const auto readPaged = [&] {
            const ShadowCache cache(path, std::uint64_t{1} << 20);
            readTransport(cache, ItemTable(cache));
        };
        if (whole) {
            EXPECT_NO_THROW(ShadowCache cache(path)) << "control";
            EXPECT_NO_THROW(readPaged()) << "control";
            continue;
        }
        const char* cause = "a ray's hit does not exist";
        test::expectError([&] { ShadowCache cache(path); }, "hits.vdb", cause);
        test::expectError([&] { verifyCache(path); }, "hits.vdb", cause);
        test::expectError(readPaged, "hits.vdb", cause);
    }
}

TEST(ItemTables, FindTheItemThatWeighsMost) {
    const Met met(bakeSmall(smallOptions()));
    ShadowCache::Reader reader(met.cache.cache());
    std::array<ItemView, ShadowCache::kMaxItems> found;
    double same = 0, all = 0;
    for (std::uint32_t i = 0; i < met.items.size(); ++i)
        for (int k = 0; k < 8; ++k) {
            const auto part = [&](int bit) { return k & bit ? 0.07 : -0.05; };
            const Vec3d place = met.items.position(i) + Vec3d(part(1), part(2), part(4));
            const int count = reader.lookUp(place, met.items.normal(i), found);
            const std::uint32_t item = met.items.itemAt(place, met.items.normal(i));
            ASSERT_EQ(count == 0, item == kNoItem);
            if (count == 0) continue;
            const auto views = std::span(found).first(static_cast<std::size_t>(count));
            ++all;
            const auto weight = [&](const ItemView& view) {
                return view.weight * met.items.exposure(static_cast<std::uint32_t>(view.number));
            };
            same += std::ranges::max(views, {}, weight).number == item;
        }
    EXPECT_GT(same / all, 0.95);
    EXPECT_EQ(met.items.itemAt({0, 50, 0}, {0, 1, 0}), kNoItem);
    EXPECT_EQ(met.items.itemAt({std::nan(""), 0, 0}, {0, 1, 0}), kNoItem);
    EXPECT_EQ(met.items.itemAt({1e300, 0, 0}, {0, 1, 0}), kNoItem);
}

/// A floor, a half of which lies `gap` below another one.
TriangleMesh halfHiddenFloor(float gap) {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -1, 1, -1, 1);
    test::addFloor(mesh, gap, -1, 0.01f, -1, 1);
    return mesh;
}

/// Mean exposure of the lower floor's items, of its hidden and its open half.
std::array<double, 2> exposures(float gap) {
    const TriangleMesh mesh = halfHiddenFloor(gap);
    const Scene scene(mesh);
    const Met met(bake(scene, smallOptions()));
    std::array<double, 2> sum{}, count{};
    for (std::uint32_t i = 0; i < met.items.size(); ++i) {
        const Vec3d place = met.items.position(i);
        if (std::abs(place.y) > 1e-3 || std::abs(place.x) < 0.3 || met.items.normal(i).y < 0.9f)
            continue;
        sum[place.x > 0] += static_cast<double>(met.items.exposure(i));
        ++count[place.x > 0];
    }
    return {sum[0] / count[0], sum[1] / count[1]};
}

TEST(BounceSolves, BrightenNoPlaceBeyondWhatRaysCanTell) {
    const TriangleMesh mesh = halfHiddenFloor(0.01f);
    const Met met(bake(Scene(mesh), smallOptions()));
    const BounceSolve solve(met.cache.cache(), met.items, met.transport,
                            test::environmentOf(test::constantMap({1, 1, 1}), 0),
                            std::vector<ItemLook>(met.items.size()), 1);
    ShadowCache::Reader reader(met.cache.cache());
    std::array<ItemView, ShadowCache::kMaxItems> found;
    float least = 1, leastOfItems = 1;
    for (std::uint32_t i = 0; i < met.items.size(); ++i) {
        const int count = reader.lookUp(met.items.position(i), met.items.normal(i), found);
        least = std::min(least,
                         solve.exposure(std::span(found).first(static_cast<std::size_t>(count))));
        leastOfItems = std::min(leastOfItems, met.items.exposure(i));
    }
    const float ofOneRay = 1 / static_cast<float>(met.transport.raysPerItem + 1);
    EXPECT_GE(least, 0.999f * ofOneRay);
    EXPECT_LT(leastOfItems, 0.1f * ofOneRay) << "control";
}

TEST(ItemTables, TellWhatIsHidden) {
    const auto [below, open] = exposures(0.01f);
    EXPECT_LT(below, 0.1);
    EXPECT_EQ(open, 1);
    EXPECT_EQ(exposures(0.5f)[0], 1) << "control";
}

}  // namespace
}  // namespace shadowcache
