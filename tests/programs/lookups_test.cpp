// What a shot looks up, found once and read by the shards of its bake.

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include "common/base/content_hash.h"
#include "tests/support/cli_fixture.h"
#include "tests/support/gltf_builder.h"

namespace shadowcache::test {
namespace {

class Lookups : public CliTest {
protected:
    /// Arguments of a bake of the shot.
    static std::string shot(const std::string& output, const std::string& more = "",
                            const std::string& set = "set.obj") {
        return set + " -o " + output +
               " --camera camera.json --frames 1-3 --size 12x8 --spacing 0.25 --level 3 " + more;
    }

    void find(const std::string& output) const {
        const ProgramRun found = runWell("bake", shot(output, "--lookups-only"));
        EXPECT_NE(found.out.find("places that the shot looks up"), std::string::npos) << found.out;
    }

    void expectSame(const std::string& a, const std::string& b) const {
        EXPECT_EQ(readBytes(path(a)), readBytes(path(b))) << a << ", " << b;
    }
};

TEST_F(Lookups, ShardsThatReadThemHaveTheSameBytes) {
    find("shot.lookups");
    for (const std::string options : {"", "--shard 1/3", "--shard 3/3 --rays 5",
                                      "--margin 2 --seed 9", "--level 1 --uniform"}) {
        runWell("bake", shot("a.vdb", options));
        runWell("bake", shot("b.vdb", options + " --lookups shot.lookups"));
        expectSame("a.vdb", "b.vdb");
    }
    runWell("bake", shot("c.vdb", "--shard 2/3 --resume --lookups shot.lookups"));
    runWell("bake", shot("d.vdb", "--shard 2/3"));
    expectSame("c.vdb", "d.vdb");
    runWell("bake", shot("d.vdb", "--frames 5"));
    runWell("bake", shot("e.vdb", "--lookups shot.lookups --extend d.vdb"));
    runWell("bake", shot("f.vdb", "--extend d.vdb"));
    expectSame("e.vdb", "f.vdb");
}

TEST_F(Lookups, HaveTheSpacingThatIsChosenAndTheSameBytesAgain) {
    const std::string shot = " --camera camera.json --frames 2 --size 12x8 --level 1 ";
    runWell("bake", "set.obj -o a.lookups --lookups-only" + shot);
    runWell("bake", "set.obj -o b.lookups --lookups-only --threads 1 --stats s.json" + shot);
    expectSame("a.lookups", "b.lookups");
    EXPECT_NE(readBytes(path("s.json")).find("\"places\""), std::string::npos);
    runWell("bake", "set.obj -o a.vdb" + shot);
    runWell("bake", "set.obj -o b.vdb --lookups a.lookups" + shot);
    expectSame("a.vdb", "b.vdb");
}

TEST_F(Lookups, OfAnotherShotAreRefused) {
    find("shot.lookups");
    const auto refused = [&](const std::string& arguments, const std::string& what) {
        expectRefusal(run("bake", arguments + " --lookups shot.lookups"), "bake", "shot.lookups",
                      "of another shot: " + what);
        EXPECT_FALSE(std::filesystem::exists(path("a.vdb")));
    };
    refused(shot("a.vdb", "", "other.obj"), "set ");
    refused(shot("a.vdb", "--frames 1-4"), "frames 1-3, expected 1-4");
    refused(shot("a.vdb", "--size 12x9"), "size 12x8, expected 12x9");
    refused(shot("a.vdb", "--spacing 0.3"), "spacing 0.25, expected 0.3");
    refused(shot("a.vdb", "--up z"), "up y, expected z");
    refused(shot("a.vdb", "--dynamic other.obj"), "shot's files ");
    // The camera file's content, whatever its name; numbers, however typed.
    std::string camera = readBytes(path("camera.json"));
    folder_.write("copy.json", camera);
    runWell("bake", shot("copy.vdb", "--camera copy.json --spacing .250 --lookups shot.lookups"));
    folder_.write("camera.json", camera.replace(camera.find("1.2"), 3, "1.3"));
    refused(shot("a.vdb"), "shot's files ");
}

TEST_F(Lookups, DamagedOrForeignAreRefused) {
    find("shot.lookups");
    const std::string whole = readBytes(path("shot.lookups"));
    const auto refused = [&](const std::string& bytes, const std::string& cause) {
        folder_.write("bad.lookups", bytes);
        expectRefusal(run("bake", shot("a.vdb", "--lookups bad.lookups")), "bake", "bad.lookups",
                      cause);
    };
    constexpr std::size_t kHead = 22;
    for (std::size_t i = 0; i < 12; ++i) {
        const std::size_t at = i * (whole.size() - 1) / 11;
        const std::string cause = at < kHead ? "not a lookups file" : "damaged";
        std::string bytes = whole;
        bytes[at] = static_cast<char>(bytes[at] ^ 1 << i % 8);
        refused(bytes, cause);
        if (at > 0) refused(whole.substr(0, at), cause);
    }
    refused(whole + "x", "damaged");
    refused(readBytes(path("set.obj")), "not a lookups file");
    expectRefusal(run("bake", shot("a.vdb", "--lookups none.lookups")), "bake", "none.lookups", "");
    expectRefusal(run("bake", shot("a.vdb", "--lookups-only")), "bake", "a.vdb", ".lookups");
}

// Cameras of a set are told apart by their whole names.
TEST_F(Lookups, OfAnotherCameraOfTheSetAreRefused) {
    GltfBuilder file = squareGltf();
    file.root({{"mesh", 0}, {"translation", {-0.5, -0.5, -3}}});
    const int lens = file.append(
        "cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}});
    for (const char* side : {"left", "right"})
        file.root({{"camera", lens}, {"name", std::string(side) + "/cam"}});
    folder_.write("set.glb", file.glb());
    const std::string shot = "set.glb --frames 1 --size 12x8 --spacing 0.25 --level 1 ";
    runWell("bake", shot + "-o a.lookups --lookups-only --camera left/cam");
    runWell("bake", shot + "-o a.vdb --lookups a.lookups --camera left/cam");
    expectRefusal(run("bake", shot + "-o b.vdb --lookups a.lookups --camera right/cam"), "bake",
                  "a.lookups", "camera left/cam, expected right/cam");
}

/// What such a file has between its head and its checksum, from the keys of places on.
struct Tail {
    explicit Tail(const std::string& whole, std::size_t keysAt) {
        std::memcpy(&count, whole.data() + keysAt, sizeof count);
        keys = whole.substr(keysAt + 8, count * 8);
        codes = whole.substr(keysAt + 16 + count * 8, count * 4);
    }
    std::string first(std::uint64_t kept) const {
        const std::string length(reinterpret_cast<const char*>(&kept), sizeof kept);
        return length + keys.substr(0, kept * 8) + length + codes.substr(0, kept * 4);
    }
    std::uint64_t count = 0;
    std::string keys, codes;
};

// With the right checksum, as no bake writes them.
TEST_F(Lookups, ForgedNumbersAreRefused) {
    find("shot.lookups");
    const std::string whole = readBytes(path("shot.lookups"));
    const auto bakeWith = [&](std::string bytes) {
        const std::uint64_t sum = checksum(std::string_view(bytes));
        bytes.append(reinterpret_cast<const char*>(&sum), sizeof sum);
        folder_.write("bad.lookups", bytes);
        return run("bake", shot("a.vdb", "--lookups bad.lookups"));
    };
    const auto refused = [&](std::size_t at, std::uint64_t bits, const std::string& cause) {
        std::string bytes = whole.substr(0, whole.size() - sizeof bits);
        std::memcpy(bytes.data() + at, &bits, sizeof bits);
        expectRefusal(bakeWith(bytes), "bake", "bad.lookups", cause);
    };
    const auto spacing = std::bit_cast<std::array<char, 8>>(0.25);
    const std::size_t at = whole.find(std::string(spacing.data(), spacing.size()));
    ASSERT_NE(at, std::string::npos);
    for (const double wrong : {0.0, -1.0, 1e13, std::nan("")})
        refused(at, std::bit_cast<std::uint64_t>(wrong), "above 0, at most 1e+12");
    refused(at, std::bit_cast<std::uint64_t>(0.5), "spacing 0.5, expected 0.25");
    refused(at + 8, ~std::uint64_t{0}, "level -1, expected 0 to 5");
    // After spacing and level.
    const std::size_t sides = at + 20, keys = at + 36;
    refused(sides, 0, " sides of ");
    refused(sides, ~std::uint64_t{0}, " sides of ");
    refused(sides, 1, " sides of the set, expected ");
    refused(keys, ~std::uint64_t{0}, "cut short");
    // Places are baked as the file has them, not found again.
    const Tail tail(whole, keys);
    ASSERT_GT(tail.count, 20u);
    EXPECT_EQ(bakeWith(whole.substr(0, keys) + tail.first(tail.count)).status, 0);
    const std::string all = readBytes(path("a.vdb"));
    EXPECT_EQ(bakeWith(whole.substr(0, keys) + tail.first(3)).status, 0);
    EXPECT_LT(readBytes(path("a.vdb")).size(), all.size());
}

// The spacing can come from the cache that is extended.
TEST_F(Lookups, FoundForAnExtendedCacheAreOfItsSpacing) {
    const std::string shot = " --camera camera.json --frames 2 --size 12x8 --level 1 ";
    runWell("bake", "set.obj -o old.vdb --spacing 0.4" + shot);
    runWell("bake", "set.obj -o a.lookups --lookups-only --extend old.vdb" + shot);
    expectRefusal(run("bake", "set.obj -o a.vdb --lookups a.lookups" + shot), "bake", "a.lookups",
                  "extended cache ");
    runWell("bake", "set.obj -o a.vdb --extend old.vdb --lookups a.lookups" + shot);
}

TEST_F(Lookups, NeedACameraAndExcludeEachOther) {
    for (const std::string options :
         {"--lookups-only -o a.lookups", "--lookups x.lookups -o a.vdb"})
        EXPECT_EQ(run("bake", "set.obj " + options).status, 2);
    const std::string both = "--lookups-only --lookups x.lookups";
    EXPECT_EQ(run("bake", shot("a.lookups", both)).status, 2);
    EXPECT_EQ(run("bake", shot("a.lookups", "--lookups-only --estimate")).status, 2);
}

}  // namespace
}  // namespace shadowcache::test
