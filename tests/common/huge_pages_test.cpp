// Large arrays ask for huge pages.

#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace shadowcache {
namespace {

/// Whether the kernel was asked for huge pages at an address, as /proc/self/smaps tells.
bool asksForHugePages(const void* address) {
    const auto at = reinterpret_cast<std::uintptr_t>(address);
    std::ifstream maps("/proc/self/smaps");
    bool isHere = false;
    for (std::string line; std::getline(maps, line);) {
        std::istringstream words(line);
        std::uintptr_t begin = 0, end = 0;
        char dash = 0;
        if (words >> std::hex >> begin >> dash >> end && dash == '-')
            isHere = begin <= at && at < end;
        else if (isHere && line.starts_with("VmFlags:"))
            return line.find(" hg") != std::string::npos;
    }
    return false;
}

TEST(HugePages, AreAskedForByLargeArrays) {
    const std::vector<char> large(std::size_t{64} << 20, 1);
    EXPECT_TRUE(asksForHugePages(large.data() + large.size() / 2));
    const std::vector<char> small(std::size_t{1} << 20, 1);  // the control
    EXPECT_FALSE(asksForHugePages(small.data()));
}

TEST(HugePages, HoldWhatTheyShould) {
    // Sizes at and beside whole pages.
    for (const std::size_t size : {std::size_t{1} << 21, (std::size_t{1} << 21) - 1,
                                   (std::size_t{1} << 21) + 1, std::size_t{5} << 20}) {
        std::vector<char> block(size, 1);
        block.back() = 2;
        EXPECT_EQ(block.front() + block.back(), 3);
    }
}

}  // namespace
}  // namespace shadowcache
