// Metadata of a cache whose lengths are wrong, in files whose checksums are right, or missing:
// OpenVDB makes room for a text before it reads it, and takes a value's length from its type.

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "common/cache/cache_items.h"
#include "common/cache/checksums.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache {
namespace {

namespace fs = std::filesystem;

/// A stored cache without its checksums.
std::string plainBytes() {
    const fs::path path = SHADOWCACHE_STORED "/format-3.vdb";
    return test::readBytes(path).substr(0, CheckedFile::open(path)->size());
}

std::uint32_t numberAt(const std::string& bytes, std::size_t at) {
    std::uint32_t number = 0;
    std::memcpy(&number, bytes.data() + at, sizeof number);
    return number;
}

/// Where the numbers of the metadata are, and of the texts that name the first grid.
std::vector<std::size_t> placesOfNumbers(const std::string& bytes) {
    // Behind magic number, three versions, a flag and the UUID.
    std::vector<std::size_t> places{8 + 3 * 4 + 1 + 36};
    std::size_t at = places[0] + 4;
    for (std::uint32_t entry = 0; entry < numberAt(bytes, places[0]); ++entry)
        for (int text = 0; text < 3; ++text) {  // name, type, value
            places.push_back(at);
            at += 4 + numberAt(bytes, at);
        }
    places.push_back(at);  // the number of grids
    at += 4;
    for (int text = 0; text < 3; ++text) {  // name, type, parent of an instance
        places.push_back(at);
        at += 4 + numberAt(bytes, at);
    }
    return places;
}

/// Reads the header of a file with a wrong number at each of the places. @return number of
/// readings that gave no error
int readingsWithout(const fs::path& path, bool sealed) {
    const std::string sound = plainBytes();
    int without = 0;
    for (const std::size_t place : placesOfNumbers(sound))
        for (const std::uint32_t wrong : {0xffffffffu, 0x7fffffffu, 0x10000000u}) {
            std::string bytes = sound;
            std::memcpy(bytes.data() + place, &wrong, sizeof wrong);
            AtomicFile file(path);
            file.write(bytes.data(), bytes.size());
            if (sealed) sealFile(file);
            file.commit();
            try {
                CacheHeader header;
                readCache(path, header);
                ++without;
            } catch (const Error& e) {
                without += std::string(e.what()).find(path.filename()) == std::string::npos;
            }
        }
    return without;
}

/// In a process of its own: whether all are refused by name, and within 512 MB.
void expectRefusals(bool sealed) {
    const test::TemporaryFolder folder;
    const pid_t child = fork();
    if (child == 0) {
        const int without = readingsWithout(folder.path() / "a.vdb", sealed);
        rusage use{};
        getrusage(RUSAGE_SELF, &use);
        _exit(without != 0 ? 1 : use.ru_maxrss < 512 * 1024 ? 0 : 2);  // [kB]
    }
    int status = -1;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
    EXPECT_EQ(WEXITSTATUS(status), 0) << "1: read, or refused without a name; 2: memory";
}

TEST(CacheMetadata, WhoseLengthsAreBeyondTheFileIsRefused) {
    expectRefusals(false);
    expectRefusals(true);
}

/// A number is as long as its type; a shorter or longer one leads OpenVDB astray.
TEST(CacheMetadata, WhoseLengthIsNotThatOfItsTypeIsRefused) {
    const test::TemporaryFolder folder;
    const std::string sound = plainBytes();
    std::size_t numbers = 0;
    for (const std::size_t place : placesOfNumbers(sound)) {
        const std::uint32_t length = numberAt(sound, place);
        std::string type;
        for (const char* name : {"bool", "int32", "int64", "double"}) {
            const std::size_t size = std::strlen(name);
            if (place >= size && sound.compare(place - size, size, name) == 0) type = name;
        }
        if (type.empty()) continue;
        ++numbers;
        for (const std::uint32_t wrong : {length - 1, length + 1}) {
            std::string bytes = sound;
            std::memcpy(bytes.data() + place, &wrong, sizeof wrong);
            const fs::path path = folder.write("a.vdb", bytes);
            test::expectError([&] { readHeader(path); }, "a.vdb", "cut short");
        }
    }
    EXPECT_EQ(numbers, 6u);
}

/// Control: sealed again as it was, it is read.
TEST(CacheMetadata, ThatIsSoundIsRead) {
    const test::TemporaryFolder folder;
    const std::string bytes = plainBytes();
    const fs::path path = folder.path() / "a.vdb";
    {
        AtomicFile file(path);
        file.write(bytes.data(), bytes.size());
        sealFile(file);
        file.commit();
    }
    EXPECT_EQ(test::readBytes(path), test::readBytes(SHADOWCACHE_STORED "/format-3.vdb"));
    EXPECT_EQ(readHeader(path).level, 4);
}

}  // namespace
}  // namespace shadowcache
