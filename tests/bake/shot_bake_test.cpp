// The bake of a shot holds the items of the whole bake that its pictures look up, bit for bit, and
// one that is extended is the bake of both shots.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>
#include <vector>

#include "bake/core/cache_part.h"
#include "bake/core/extend.h"
#include "bake/core/hit_tracer.h"
#include "bake/core/surface_count.h"
#include "bake/core/surface_voxels.h"
#include "bake/shot/shot_source.h"
#include "common/import/load_mesh.h"
#include "common/shot/camera_file.h"
#include "common/shot/frames.h"
#include "common/shot/view.h"
#include "render/frame/integrator.h"
#include "render/frame/pilot.h"
#include "scenes/sets.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

constexpr int kFrames = 24;

/// The bundled courtyard with its camera, and its whole bake.
struct Courtyard {
    test::TemporaryFolder folder;
    std::vector<std::filesystem::path> files{folder.path() / "set.ply"};
    std::filesystem::path camera = folder.path() / "camera.json";
    TriangleMesh mesh;
    std::optional<Scene> scene;
    BakeOptions options;
    BakeResult whole;

    Courtyard() {
        scenes::writePly(files[0], scenes::makeCourtyard());
        scenes::writeCamera(camera, scenes::courtyardWalk(), kFrames, 24, 0.9);
        mesh = loadMesh(files, {});
        scene.emplace(mesh);
        options.spacing = 1.2;
        options.level = 2;
        options.rays = 4;
        whole = bake(*scene, options);
    }

    VoxelSelection selectionOf(const std::string& frames, int margin = 0) {
        ShotOptions shot;
        shot.camera.name = camera.string();
        shot.frames = frames;
        shot.size = {320, 180};
        const MeshOptions none;
        VoxelSelection selection;
        selection.lookups =
            ShotSource(shot, files, none).lookups(*scene, VoxelFrame(mesh, options.spacing));
        selection.margin = margin;
        return selection;
    }

    BakeResult bakeOf(const std::string& frames, int margin = 0) {
        return bake(*scene, options, selectionOf(frames, margin));
    }
};

Courtyard& courtyard() {
    static Courtyard set;
    return set;
}

bool sameItem(const CacheItems& a, std::size_t i, const CacheItems& b, std::size_t j,
              std::size_t cells) {
    const auto row = [&](const std::vector<std::uint8_t>& counts, std::size_t item) {
        return std::span(counts).subspan(item * cells, cells);
    };
    const auto hits = [](const CacheItems& items, std::size_t item) {
        return std::span(items.hits).subspan(item * kHitRays, kHitRays);
    };
    const auto blocks = [](const CacheItems& items, std::size_t item) {
        return std::span(items.blocks)
            .subspan(items.firstBlock[item], items.firstBlock[item + 1] - items.firstBlock[item]);
    };
    return a.normal[i] == b.normal[j] && a.position[i] == b.position[j] &&
           std::ranges::equal(row(a.n, i), row(b.n, j)) &&
           std::ranges::equal(row(a.d, i), row(b.d, j)) &&
           std::ranges::equal(hits(a, i), hits(b, j)) &&
           std::ranges::equal(blocks(a, i), blocks(b, j), [](const auto& x, const auto& y) {
               return x.key == y.key && x.n == y.n && x.d == y.d;
           });
}

/// Items of `part` that are not, with the same bits, in `whole`.
std::size_t strangers(const CacheItems& part, const CacheItems& whole, std::size_t cells) {
    std::size_t count = 0, i = 0;
    for (std::size_t j = 0; j < part.size(); ++j) {
        while (i < whole.size() && itemBefore(whole, i, part, j)) ++i;
        count += i == whole.size() || itemBefore(part, j, whole, i) ||
                         !sameItem(whole, i, part, j, cells)
                     ? 1
                     : 0;
    }
    return count;
}

void expectSame(const CacheItems& a, const CacheItems& b) {
    EXPECT_EQ(a.size(), b.size());
    const std::uint32_t cells = DirectionTiers{courtyard().options.level}.baseCells();
    EXPECT_EQ(strangers(a, b, cells), 0u);
}

Camera cameraOf(int frame) {
    return cameraAtFrame(readCameraFile(courtyard().camera), frame);
}

/// A frame under a map, with what it took.
Film picture(const ShadowCache& cache, int frame, RenderStats& stats) {
    static const Environment kLight = test::environmentOf(test::noiseMap(32, 16, 5));
    const auto estimator =
        findEstimator("cache").make({*courtyard().scene, kLight, &cache, Sequence::kSobol});
    RenderOptions options;
    options.width = 320;
    options.height = 180;
    options.samples = 1;
    FrameRequest request{*estimator, cameraOf(frame), frame, options};
    request.plan = planFrame(request, stats);
    return render(request, stats);
}

/// Share of the camera rays that find no item.
double misses(const BakeResult& baked, int frame) {
    const test::TestCache cache(baked);
    RenderStats stats;
    picture(cache.cache(), frame, stats);
    return static_cast<double>(stats.raysWithoutItems) / static_cast<double>(stats.cameraRays);
}

TEST(ShotBake, HoldsItemsOfTheWholeBake) {
    Courtyard& set = courtyard();
    for (const int margin : {0, 1}) {
        const BakeResult part = set.bakeOf("1", margin);
        EXPECT_GT(part.items.size(), 100u);
        EXPECT_LT(part.items.size(), set.whole.items.size());
        EXPECT_LT(part.rays, set.whole.rays);
        EXPECT_EQ(strangers(part.items, set.whole.items, set.whole.header.tiers().baseCells()), 0u);
    }
}

TEST(ShotBake, HoldsWhatItsPicturesLookUp) {
    EXPECT_LT(misses(courtyard().bakeOf("1,24"), 1), 1e-3);
    EXPECT_LT(misses(courtyard().bakeOf("1,24"), 24), 1e-3);
}

// Control: the test above must see what is missing.
TEST(ShotBake, DoesNotHoldWhatOthersLookUp) {
    EXPECT_GT(misses(courtyard().bakeOf("24"), 1), 1e-2);
}

/// Share of the lookups of a frame in which the two caches find other items or weights.
double differentLookups(const BakeResult& a, const BakeResult& b, int frame) {
    const test::TestCache cacheA(a), cacheB(b);
    ShadowCache::Reader readerA(cacheA.cache()), readerB(cacheB.cache());
    std::array<ItemView, ShadowCache::kMaxItems> itemsA, itemsB;
    constexpr int kWidth = 160, kHeight = 90;
    const Scene& scene = *courtyard().scene;
    const CameraRays rays(cameraOf(frame), static_cast<double>(kWidth) / kHeight);
    double all = 0, different = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const View view =
                lookAlong(rays.through({(x + 0.5) / kWidth, (y + 0.5) / kHeight}), scene, 0.5f);
            if (!view.hit.found) continue;
            const Vec3d place = worldPosition(scene, view.hit);
            const auto countA = readerA.lookUp(place, view.geometricNormal(), itemsA);
            const auto countB = readerB.lookUp(place, view.geometricNormal(), itemsB);
            const auto same = [](const ItemView& p, const ItemView& q) {
                return p.weight == q.weight && p.normal == q.normal &&
                       std::equal(p.n, p.n + 20, q.n) && std::equal(p.d, p.d + 20, q.d);
            };
            all += 1;
            if (!std::equal(itemsA.begin(), itemsA.begin() + countA, itemsB.begin(),
                            itemsB.begin() + countB, same))
                different += 1;
        }
    return different / all;
}

TEST(ShotBake, AnswersLookupsAsTheWholeBakeDoes) {
    const BakeResult& whole = courtyard().whole;
    EXPECT_LT(differentLookups(courtyard().bakeOf("1"), whole, 1), 0.01);
    // Control: another shot's items do not.
    EXPECT_GT(differentLookups(courtyard().bakeOf("24"), whole, 1), 0.1);
}

TEST(ShotBake, ExtendedIsTheBakeOfBothShots) {
    Courtyard& set = courtyard();
    const BakeResult first = set.bakeOf("1");
    const std::filesystem::path file = set.folder.path() / "first.vdb";
    writeCache(file, first.header, first.items);
    const CacheToExtend old = readCacheToExtend(file, first.header);
    VoxelSelection second = set.selectionOf("24");
    second.present = VoxelSides(VoxelFrame(set.mesh, set.options.spacing), old.items);
    BakeResult more = bake(*set.scene, set.options, second);
    const BakeResult alone = set.bakeOf("24"), both = set.bakeOf("1,24");
    EXPECT_LT(more.items.size(), alone.items.size());
    addCache(old, more);
    EXPECT_GT(more.items.size(), alone.items.size());
    expectSame(more.items, both.items);
    expectSame(both.items, more.items);
}

TEST(ShotBake, ExtendedToTheWholeSetIsTheWholeBake) {
    Courtyard& set = courtyard();
    const BakeResult first = set.bakeOf("1");
    VoxelSelection rest;
    rest.present = VoxelSides(VoxelFrame(set.mesh, set.options.spacing), first.items);
    BakeResult all = bake(*set.scene, set.options, rest);
    addCache({first.header, first.items}, all);
    expectSame(all.items, set.whole.items);
}

TEST(ShotBake, OfShardsIsThatOfTheShot) {
    Courtyard& set = courtyard();
    const VoxelSelection selection = set.selectionOf("1");
    CacheItems sum;
    BakeOptions options = set.options;
    options.shards = 3;
    for (options.shard = 0; options.shard < 3; ++options.shard)
        append(sum, bake(*set.scene, options, selection).items);
    expectSame(sum, bake(*set.scene, set.options, selection).items);
}

// Against a look at every voxel of the set.
TEST(SurfaceVoxels, AreFoundAround) {
    const SurfaceVoxels voxels(courtyard().mesh, 1.2, {}, {});
    for (const int margin : {0, 1, 5, 8, 33, 64})
        for (std::size_t v = 0; v < voxels.size(); v += 97) {
            std::vector<std::size_t> expected, found;
            for (std::size_t other = 0; other < voxels.size(); ++other) {
                const Vec3i way = voxels.voxel(other) - voxels.voxel(v);
                if (std::max({std::abs(way.x), std::abs(way.y), std::abs(way.z)}) <= margin)
                    expected.push_back(other);
            }
            voxels.searchAround(v, margin, [&](std::size_t other) {
                found.push_back(other);
                return false;
            });
            std::ranges::sort(found);
            ASSERT_EQ(found, expected) << v << ", margin " << margin;
            std::size_t visits = 0;
            voxels.searchAround(v, margin, [&](std::size_t) { return ++visits == 1; });
            EXPECT_EQ(visits, 1u);
        }
}

TEST(SurfaceCount, CountsTheSidesOfAWholeBake) {
    Courtyard& set = courtyard();
    const SurfaceCount count = countSurface(set.mesh, VoxelFrame(set.mesh, set.options.spacing));
    EXPECT_EQ(count.sides, countSides(set.whole.items));
}

TEST(CachePart, IsKeptByTheFile) {
    const test::TemporaryFolder folder;
    BakeResult part = courtyard().bakeOf("1");
    part.header.part = {7, 9, "camera.json, frames 1, 320x180"};
    writeCache(folder.path() / "part.vdb", part.header, part.items);
    const CacheHeader header = readHeader(folder.path() / "part.vdb");
    ASSERT_TRUE(header.part);
    EXPECT_EQ(header.part->sides, 7u);
    EXPECT_EQ(header.part->sidesOfSet, 9u);
    EXPECT_EQ(header.part->shots, "camera.json, frames 1, 320x180");
    writeCache(folder.path() / "whole.vdb", courtyard().whole.header, courtyard().whole.items);
    EXPECT_FALSE(readHeader(folder.path() / "whole.vdb").part);
}

TEST(CachePart, JoinsShotsOnce) {
    const CacheItems none;
    EXPECT_EQ(joinParts({1, 9, "a; b"}, {1, 9, "b; c"}).shots, "a; b; c");
    ASSERT_TRUE(countPart({1, 9, "a"}, none));
    EXPECT_EQ(countPart({1, 9, "a"}, none)->sides, 0u);
    EXPECT_FALSE(countPart({1, 0, "a"}, none)) << "all of it";
}

// The file's order of leaves is that of OpenVDB's tree, whose upper nodes hold 128 voxels.
TEST(ReadCache, SortsItemsOfLargeSets) {
    const test::TemporaryFolder folder;
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -20, 20, -20, 20);
    const Scene scene(mesh);
    BakeOptions options;
    options.spacing = 0.2;
    options.level = 0;
    options.rays = 1;
    const BakeResult baked = bake(scene, options);
    writeCache(folder.path() / "floor.vdb", baked.header, baked.items);
    CacheHeader header;
    EXPECT_EQ(readCache(folder.path() / "floor.vdb", header).voxel, baked.items.voxel);
}

}  // namespace
}  // namespace shadowcache
