// Counts of emitters that a cache was baked without are those of a bake with them; a cache that
// counts other emitters is refused in words.

#include "bake/core/emitter_recount.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "bake/core/emitter_match.h"
#include "bake/core/extend.h"
#include "bake/core/merge_order.h"
#include "common/cache/patch_code.h"
#include "tests/support/small_bake.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache {
namespace {

namespace fs = std::filesystem;

Lamp lampAt(const std::string& name, const Vec3d& position) {
    Lamp lamp;
    lamp.name = name;
    lamp.position = position;
    lamp.radius = 0.05;
    lamp.strength = Rgb(1, 1, 1);
    return lamp;
}

TriangleMesh litMesh() {
    TriangleMesh mesh = test::smallMesh();
    mesh.lamps = {lampAt("desk", {0, 1, 0}), lampAt("shelf", {-0.6, 0.2, 0.7})};
    return mesh;
}

BakeOptions optionsWith(bool lamps) {
    BakeOptions options = test::smallOptions();
    options.lamps = lamps;
    return options;
}

class EmitterRecountTest : public testing::Test {
protected:
    fs::path write(const std::string& name, const BakeResult& baked) const {
        writeCache(folder_.path() / name, baked.header, baked.items);
        return folder_.path() / name;
    }
    CacheToExtend readAs(const fs::path& path, const TriangleMesh& mesh, bool lamps = true) const {
        return readCacheToExtend(path, headerOf(mesh, optionsWith(lamps)),
                                 emitterLabels(mesh, optionsWith(lamps)));
    }

    const test::TemporaryFolder folder_;
    const TriangleMesh mesh_ = litMesh();
    const Scene scene_{mesh_};
    const VoxelFrame frame_{mesh_, test::smallOptions().spacing};
    const BakeResult with_ = bake(scene_, optionsWith(true));
    const BakeResult without_ = bake(scene_, optionsWith(false));
};

TEST_F(EmitterRecountTest, HasTheCountsOfTheBake) {
    ASSERT_TRUE(without_.items.emitters.empty());
    EXPECT_TRUE(std::ranges::any_of(with_.items.patch, [](std::int16_t packed) {
        return PatchCode::of(packed).subpatch != 0;
    }));
    CacheItems items = without_.items;
    EXPECT_EQ(recountEmitters(scene_, optionsWith(true), frame_, "a.vdb", items),
              with_.emitterRays);
    EXPECT_EQ(items.emitters, with_.items.emitters);
    EXPECT_EQ(with_.rays, without_.rays + with_.emitterRays);
}

TEST_F(EmitterRecountTest, MakesAnExtendedCacheTheBakeOfBoth) {
    CacheToExtend old = readAs(write("old.vdb", without_), mesh_);
    ASSERT_TRUE(lacksEmitters(old, with_.header));
    recountEmitters(scene_, optionsWith(true), frame_, "old.vdb", old.items);
    VoxelSelection rest;
    rest.present = VoxelSides(frame_, old.items);
    BakeResult more = bake(scene_, optionsWith(true), rest);
    EXPECT_EQ(more.items.size(), 0u);
    addCache(old, more);
    write("both.vdb", more);
    write("with.vdb", with_);
    EXPECT_EQ(test::readBytes(folder_.path() / "both.vdb"),
              test::readBytes(folder_.path() / "with.vdb"));
    EXPECT_FALSE(lacksEmitters(readAs(folder_.path() / "both.vdb", mesh_), with_.header));
}

TEST_F(EmitterRecountTest, NamesAFileWithItemsOfAnotherSet) {
    CacheItems items = without_.items;
    items.patch.back() =
        PatchCode{PatchCode::of(items.patch.back()).side, kMaxDepthLayers - 1, 0}.packed();
    test::expectError([&] { recountEmitters(scene_, optionsWith(true), frame_, "a.vdb", items); },
                      "a.vdb", "expected those of a bake of it");
}

TEST_F(EmitterRecountTest, NamesALampThatWasMovedBeforeAnExtension) {
    const fs::path old = write("old.vdb", with_);
    TriangleMesh moved = litMesh();
    moved.lamps[1].position.x += 0.01;
    test::expectError([&] { readAs(old, moved); }, "old.vdb",
                      "does not count 1 of the 2 emitters of this bake where they are, first "
                      "'shelf': moved, reshaped or added since the bake");
    TriangleMesh fewer = litMesh();
    fewer.lamps.pop_back();
    test::expectError([&] { readAs(old, fewer); }, "old.vdb",
                      "counts 2 emitters, expected the 1 of this bake: the others were moved");
    test::expectError([&] { readAs(old, mesh_, false); }, "old.vdb",
                      "counts 2 emitters, expected none as in this bake, which is of --no-lamps");
}

TEST_F(EmitterRecountTest, TellsShardsWithLampsFromThoseWithout) {
    const auto shard = [&](const TriangleMesh& mesh, int number, bool lamps) {
        BakeOptions options = optionsWith(lamps);
        options.shards = 2;
        options.shard = number;
        return write("shard" + std::to_string(number) + ".vdb", bake(Scene(mesh), options));
    };
    const auto refuse = [](const std::vector<fs::path>& paths, const std::string& cause) {
        test::expectError([&] { orderMerge(paths); }, "shard1.vdb", cause);
    };
    const fs::path first = shard(mesh_, 0, true);
    refuse({first, shard(mesh_, 1, false)}, "counts no emitters, expected the 2 of " +
                                                first.string() + ": it was baked with --no-lamps");
    TriangleMesh moved = litMesh();
    moved.lamps[0].position.x += 0.01;
    refuse({first, shard(moved, 1, true)},
           "does not count 1 of the 2 emitters of " + first.string() + " where they are: moved");
    const fs::path dark = shard(mesh_, 0, false);
    refuse({dark, shard(mesh_, 1, true)},
           "counts 2 emitters, expected none as in " + dark.string());
}

}  // namespace
}  // namespace shadowcache
