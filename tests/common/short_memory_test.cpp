// Where libraries keep it to themselves that memory ended, ours do not.

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include "common/base/text_streams.h"
#include "common/image/exr.h"
#include "tests/support/temporary_folder.h"

namespace {

bool memoryEnded = false;

/// While it lives, nothing is allocated by `new`.
struct NoMemory {
    NoMemory() { memoryEnded = true; }
    ~NoMemory() { memoryEnded = false; }
};

}  // namespace

// Not inlined: where only one of a pair is, compilers take the other for the wrong one.
[[gnu::noinline]] void* operator new(std::size_t size) {
    if (memoryEnded) throw std::bad_alloc();
    if (void* block = std::malloc(size)) return block;
    throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* block) noexcept {
    std::free(block);
}
[[gnu::noinline]] void operator delete(void* block, std::size_t) noexcept {
    std::free(block);
}

namespace {

bool compressorFails = false;

}  // namespace

/// zlib's, in front of the library's own: OpenEXR calls it for each block of rows.
extern "C" int compress2(unsigned char* to, unsigned long* toSize, const unsigned char* from,
                         unsigned long size, int level) {
    constexpr int kNoMemory = -4;  // Z_MEM_ERROR
    if (compressorFails) return kNoMemory;
    static const auto real = reinterpret_cast<decltype(&compress2)>(dlsym(RTLD_NEXT, "compress2"));
    return real(to, toSize, from, size, level);
}

namespace shadowcache {
namespace {

constexpr const char* kLong = "a text that is longer than a string holds without an allocation";

TEST(ShortMemory, ThrowsFromATextThatIsWritten) {
    TextWriter ours;
    std::ostringstream control;
    const NoMemory now;
    EXPECT_THROW(ours << kLong, std::bad_alloc);
    EXPECT_NO_THROW(control << kLong);
}

TEST(ShortMemory, ThrowsFromATextThatIsRead) {
    TextReader ours(kLong);
    std::istringstream control(kLong);
    std::string line, other;
    const NoMemory now;
    EXPECT_THROW(std::getline(ours, line), std::bad_alloc);
    EXPECT_NO_THROW(std::getline(control, other));
}

void writePicture(const std::filesystem::path& path) {
    writeExr(path, 8, 40, {{"Y", std::vector<float>(8 * 40, 1.0f)}}, {}, PixelType::full);
}

TEST(ShortMemory, LeavesNoPictureWithoutItsRows) {
    const test::TemporaryFolder folder;
    const auto path = folder.path() / "a.exr";
    compressorFails = true;
    test::expectError([&] { writePicture(path); }, path.string(),
                      "not all rows could be compressed");
    compressorFails = false;
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
    writePicture(path);
    EXPECT_TRUE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace shadowcache
