// Patches that see more of the sky on one half than on the other are cut, and the lookup goes by
// the subpatch that the place lies in.

#include "bake/core/subpatches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

#include "common/cache/cache_items.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

constexpr double kUnitSpacing = 1;
constexpr int kUpperSide = 2;

/// A floor whose part x < edge lies in a closed box; in the voxel around the origin the side of the
/// box stands on it.
TriangleMesh halfHidden(float edge) {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -1.5f, 1.5f, -1.5f, 1.5f);
    test::addQuad(mesh, {edge, 0, -2}, {edge, 0, 2}, {edge, 1, 2}, {edge, 1, -2});
    test::addQuad(mesh, {-2, 0, -2}, {-2, 0, 2}, {-2, 1, 2}, {-2, 1, -2});
    test::addFloor(mesh, 1, -2, edge, -2, 2);
    test::addQuad(mesh, {-2, 0, -2}, {edge, 0, -2}, {edge, 1, -2}, {-2, 1, -2});
    test::addQuad(mesh, {-2, 0, 2}, {edge, 0, 2}, {edge, 1, 2}, {-2, 1, 2});
    return mesh;
}

BakeResult bakedOf(const TriangleMesh& mesh, bool adaptive = true) {
    const Scene scene(mesh);
    BakeOptions options;
    options.spacing = kUnitSpacing;
    options.level = 3;
    options.adaptive = adaptive;
    return bake(scene, options);
}

/// Parts of the floor's upper side in a voxel.
std::vector<SubpatchCode> subpatchesOf(const CacheItems& items, const Vec3i& voxel) {
    std::vector<SubpatchCode> parts;
    for (std::size_t i = 0; i < items.size(); ++i) {
        const PatchCode code = PatchCode::of(items.patch[i]);
        if (items.voxel[i] == voxel && code.side == kUpperSide && items.position[i].y < 0.25f)
            parts.push_back(code.subpatch);
    }
    return parts;
}

/// Share of the rays of all items found at (x, y, z), facing up, that met nothing.
float openAt(const ShadowCache& cache, double x, double z, double y = 0) {
    ShadowCache::Reader reader(cache);
    std::array<ItemView, ShadowCache::kMaxItems> items;
    const int found = reader.lookUp({x, y, z}, {0, 1, 0}, items);
    float open = 0, sum = 0;
    for (int i = 0; i < found; ++i) {
        const ItemView& item = items[static_cast<std::size_t>(i)];
        int n = 0, d = 0;
        for (std::uint32_t c = 0; c < cache.header().tiers().baseCells(); ++c) {
            n += item.n[c];
            d += item.d[c];
        }
        open += item.weight * static_cast<float>(n) / static_cast<float>(d);
        sum += item.weight;
    }
    EXPECT_NEAR(sum, 1, 1e-5f);
    return open;
}

TEST(PatchCode, IsReadAsItWasPacked) {
    std::set<std::int16_t> seen;
    for (int side = 0; side < kSides; ++side)
        for (int layer = 0; layer < kMaxDepthLayers; ++layer)
            for (SubpatchCode subpatch = 0; subpatch < kSubpatchCodes; ++subpatch) {
                const PatchCode code{side, layer, subpatch};
                const PatchCode read = PatchCode::of(code.packed());
                EXPECT_EQ(read.side, side);
                EXPECT_EQ(read.layer, layer);
                EXPECT_EQ(read.subpatch, subpatch);
                seen.insert(code.packed());
            }
    EXPECT_EQ(seen.size(), std::size_t{kSides * kMaxDepthLayers * kSubpatchCodes});
    EXPECT_GE(*seen.begin(), 0);
}

TEST(PatchCode, OfADamagedFileIsTold) {
    for (const PatchCode code : {PatchCode{0, 0, 0}, {5, 3, 124}, {2, 1, 25}, {2, 0, 30}})
        EXPECT_TRUE(PatchCode::isValid(code.packed()));
    EXPECT_FALSE(PatchCode::isValid(-1));
    EXPECT_FALSE(PatchCode::isValid(kSubpatchCodes * kMaxDepthLayers * kSides));
    for (const SubpatchCode hole : {1, 5, 26})
        EXPECT_FALSE(PatchCode::isValid(PatchCode{0, 0, hole}.packed()));
}

// The subpatches of one level lie side by side on a lattice, each once.
TEST(PatchCode, SubpatchesTileTheirParent) {
    std::vector<SubpatchCode> parts{0};
    for (int cuts = 0; cuts < kMaxSubdivisions; ++cuts) {
        std::vector<SubpatchCode> finer;
        std::set<std::array<float, 2>> middles;
        for (const SubpatchCode part : parts) {
            EXPECT_EQ(subdivisionsOf(part), cuts);
            for (int q = 0; q < 4; ++q) {
                finer.push_back(subpatchOf(part, q));
                middles.insert(middleOf(finer.back()));
                for (const std::size_t k : {0u, 1u})
                    EXPECT_EQ(std::abs(middleOf(finer.back())[k] - middleOf(part)[k]),
                              0.25f / static_cast<float>(1 << cuts));
            }
        }
        EXPECT_TRUE(std::is_sorted(finer.begin(), finer.end()));
        EXPECT_EQ(middles.size(), finer.size());
        parts = finer;
    }
}

TEST(Subpatches, OfAPatchHoldAllOfIt) {
    const TriangleMesh mesh = halfHidden(0.2f);
    const Scene scene(mesh);
    const VoxelFrame frame(mesh, kUnitSpacing);
    const auto fragments = placeFragments(mesh, frame);
    const auto inVoxel = [&](const Fragment& f) { return f.voxelKey == frame.key({0, 0, 0}); };
    const auto begin = std::find_if(fragments.begin(), fragments.end(), inVoxel);
    const auto end = std::find_if_not(begin, fragments.end(), inVoxel);
    const auto patches = makePatches(scene, frame, {begin, end}, 1);
    const auto floor = std::find_if(patches.begin(), patches.end(),
                                    [](const Patch& p) { return p.code.side == kUpperSide; });
    ASSERT_NE(floor, patches.end());
    const auto subpatches = makeSubpatches(scene, frame.center({0, 0, 0}), kUnitSpacing, *floor);
    ASSERT_EQ(subpatches.size(), 4u);
    double area = 0;
    for (const Patch& q : subpatches) {
        for (const Piece& piece : q.pieces) area += static_cast<double>(piece.area);
        for (const Vec3f& origin : q.origin)
            for (const int axis : {0, 2})
                EXPECT_LE(std::abs(static_cast<double>(origin[axis]) - q.box.center[axis]),
                          q.box.half[axis] + 1e-4);
    }
    EXPECT_NEAR(area, kUnitSpacing * kUnitSpacing, 1e-5);
}

TEST(Subpatches, AreMadeWhereTheSkyDiffers) {
    const std::vector<SubpatchCode> parts =
        subpatchesOf(bakedOf(halfHidden(0.2f)).items, {0, 0, 0});
    // Down to the smallest along the edge, as coarse as it goes elsewhere.
    EXPECT_EQ(std::count_if(parts.begin(), parts.end(),
                            [](SubpatchCode p) { return subdivisionsOf(p) == kMaxSubdivisions; }),
              std::ptrdiff_t{2 << kMaxSubdivisions});
    EXPECT_LT(parts.size(), 32u);
    // Controls: a floor that all sees alike, and a bake that looks at no differences.
    TriangleMesh open;
    test::addFloor(open, 0, -1.5f, 1.5f, -1.5f, 1.5f);
    test::addFloor(open, 20, -1, 1, -1, 1);
    EXPECT_EQ(subpatchesOf(bakedOf(open).items, {0, 0, 0}), std::vector<SubpatchCode>{0});
    EXPECT_EQ(subpatchesOf(bakedOf(halfHidden(0.2f), false).items, {0, 0, 0}),
              std::vector<SubpatchCode>{0});
}

TEST(Subpatches, OfFoldedSurfaceAreNone) {
    TriangleMesh mesh = halfHidden(0.2f);
    // Blades across the voxel, almost as steep as the side lets them be; they touch the floor.
    for (int i = 0; i < 8; ++i) {
        const float x = -0.4f + 0.1f * static_cast<float>(i);
        test::addQuad(mesh, {x, 0, -0.5f}, {x, 0, 0.5f}, {x + 0.1f, 0.09f, 0.5f},
                      {x + 0.1f, 0.09f, -0.5f});
        test::addQuad(mesh, {x, 0.09f, -0.5f}, {x, 0.09f, 0.5f}, {x + 0.1f, 0, 0.5f},
                      {x + 0.1f, 0, -0.5f});
    }
    for (const SubpatchCode part : subpatchesOf(bakedOf(mesh).items, {0, 0, 0})) EXPECT_EQ(part, 0);
}

TEST(Subpatches, AreTheSameInShardsAndInParts) {
    const BakeResult whole = bakedOf(halfHidden(0.2f));
    const TriangleMesh mesh = halfHidden(0.2f);
    const Scene scene(mesh);
    CacheItems sum;
    for (int shard = 0; shard < 3; ++shard) {
        BakeOptions options;
        options.spacing = kUnitSpacing;
        options.level = 3;
        options.shards = 3;
        options.shard = shard;
        sum = mergeItems(sum, bake(scene, options).items, whole.header.tiers(), Overlap::keep);
    }
    ASSERT_GT(subpatchesOf(whole.items, {0, 0, 0}).size(), 1u);
    EXPECT_EQ(sum.voxel, whole.items.voxel);
    EXPECT_EQ(sum.patch, whole.items.patch);
    EXPECT_EQ(sum.n, whole.items.n);
    EXPECT_EQ(sum.d, whole.items.d);

    const test::TemporaryFolder folder;
    const auto path = folder.path() / "cache.vdb";
    writeCache(path, whole.header, whole.items);
    CacheHeader header;
    EXPECT_EQ(readCache(path, header).patch, whole.items.patch);
    const ShadowCache all(path), parts(path, 1);
    for (const double x : {-0.3, 0.1, 0.19, 0.21, 0.6})
        EXPECT_EQ(openAt(all, x, 0.1), openAt(parts, x, 0.1));
}

// A bake that cut a patch and one that did not make one cache, in which the parts count.
TEST(Subpatches, MergeWithWholePatches) {
    const BakeResult cut = bakedOf(halfHidden(0.2f)), whole = bakedOf(halfHidden(0.2f), false);
    const test::TestCache cache(
        cut.header, mergeItems(cut.items, whole.items, cut.header.tiers(), Overlap::add));
    EXPECT_LT(openAt(cache.cache(), 0.0, 0.1), 0.06f);
    EXPECT_GT(openAt(cache.cache(), 0.4, 0.1), 0.4f);
}

// A subdivided surface counts no more for another one right above it, in the next voxel, than a
// whole one would: 0.62 of the word is the upper one's own, and would be 0.4 if parts went before
// it.
TEST(Lookup, KeepsToItsLayer) {
    const auto openAbove = [](bool floorBelow) {
        TriangleMesh mesh = halfHidden(0.2f);
        if (!floorBelow) mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + 2);
        for (Vec3f& p : mesh.positions) p.y += 0.45f;
        test::addFloor(mesh, 0.55f, 0.25f, 1.4f, -1.4f, 1.4f);
        const test::TestCache cache(bakedOf(mesh));
        return openAt(cache.cache(), 0.4, 0.1, 0.55);
    };
    EXPECT_GT(openAbove(true), 0.55f * openAbove(false));
}

TEST(Lookup, GoesByThePartOfThePlace) {
    const test::TestCache cache(bakedOf(halfHidden(0.2f)));
    const test::TestCache whole(bakedOf(halfHidden(0.2f), false));
    for (const double z : {-0.3, 0.0, 0.21}) {
        SCOPED_TRACE(z);
        EXPECT_LT(openAt(cache.cache(), 0.0, z), 0.01f);
        EXPECT_GT(openAt(cache.cache(), 0.4, z), 0.4f);
        EXPECT_GT(openAt(whole.cache(), 0.0, z), 0.1f);  // control
        EXPECT_LT(openAt(whole.cache(), 0.4, z), 0.4f);
    }
}

// Along a line that crosses from parts to whole patches nothing jumps.
TEST(Lookup, HasNoSeamsWhereTheCutPatchesEnd) {
    const test::TestCache cache(bakedOf(halfHidden(0.2f)));
    float before = openAt(cache.cache(), 0.3, 0.1);
    for (int i = 1; i < 450; ++i) {
        const double x = 0.3 + 0.002 * i;
        const float now = openAt(cache.cache(), x, 0.1);
        EXPECT_LT(std::abs(now - before), 0.02f) << x;
        before = now;
    }
}

}  // namespace
}  // namespace shadowcache
