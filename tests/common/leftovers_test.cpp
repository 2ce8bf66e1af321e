// Files that runs write at once, and what dead runs leave of them.

#include "common/base/leftovers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "common/base/atomic_file.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

namespace fs = std::filesystem;

void put(AtomicFile& file, const std::string& text) {
    file.write(text.data(), text.size());
}

// Containers may share a host name and the numbers of their processes: as one process twice.
TEST(Leftovers, RunsOfOneNameWriteOneFileAtOnce) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr";
    AtomicFile first(path);
    put(first, "first");
    AtomicFile second(path);
    put(second, "second");
    std::vector<Leftover> kept;
    EXPECT_TRUE(removeLeftovers(path, kept).empty()) << "both are locked";
    EXPECT_TRUE(kept.empty()) << "ours";
    first.commit();
    EXPECT_EQ(readBytes(path), "first");
    EXPECT_TRUE(removeLeftovers(path, kept).empty());
    second.commit();
    EXPECT_EQ(readBytes(path), "second");
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
}

TEST(Leftovers, OfThisProcesssNumberAreRemoved) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr";
    const fs::path dead = temporaryPath(path);
    folder.write(dead.filename().string(), "x");
    folder.write("a.exr" + std::string(kTemporaryMark) + "12-7-another.machine~01234567", "x");
    std::vector<Leftover> kept;
    const auto removed = removeLeftovers(path, kept);
    ASSERT_EQ(removed.size(), 1u);
    EXPECT_EQ(removed[0].path, dead);
    ASSERT_EQ(kept.size(), 1u) << "of another machine nothing is known";
    EXPECT_FALSE(fs::exists(dead));
}

TEST(Leftovers, NamesAreNew) {
    EXPECT_NE(temporaryPath("a"), temporaryPath("a"));
    EXPECT_TRUE(mayBeAlive(runName()));
    EXPECT_TRUE(mayBeAlive(runName() + "~01234567"));
}

// A name may have the 255 bytes that the file system has.
TEST(Leftovers, NamesMayBeLong) {
    for (const std::size_t length : {100u, 101u, 239u, 255u}) {
        const TemporaryFolder folder;
        const fs::path path = folder.path() / (std::string(length - 4, 'a') + ".exr");
        const fs::path other = folder.path() / (std::string(length - 5, 'a') + "b.exr");
        std::optional<AtomicFile> file(std::in_place, path);
        file->commit();
        EXPECT_TRUE(fs::exists(path));
        const fs::path dead = temporaryPath(path);
        EXPECT_LE(dead.filename().string().size(), 255u);
        folder.write(dead.filename().string(), "x");
        std::vector<Leftover> kept;
        EXPECT_TRUE(removeLeftovers(other, kept).empty()) << "of another file";
        EXPECT_EQ(removeLeftovers(path, kept).size(), 1u);
    }
    const TemporaryFolder folder;
    expectError([&] { AtomicFile file(folder.path() / std::string(256, 'a')); }, "aaa",
                "File name too long");
}

}  // namespace
}  // namespace shadowcache::test
