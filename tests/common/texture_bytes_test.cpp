// Pictures as cameras and other programs write them: with bytes behind their end, or marks within.

#include <gtest/gtest.h>

#include "common/image/png.h"
#include "common/import/texture_decoder.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

std::string segment(char marker, const std::string& content) {
    const std::size_t length = content.size() + 2;
    return std::string("\xff") + marker + static_cast<char>(length >> 8) +
           static_cast<char>(length & 255) + content;
}

/// A Huffman table of one code.
std::string table(char kind) {
    return segment('\xc4', kind + std::string("\1") + std::string(16, '\0'));
}

/// 8 x 8 texels of a middle grey.
std::string jpeg(const std::string& more = "") {
    return "\xff\xd8" + segment('\xdb', std::string(1, '\0') + std::string(64, '\1')) + more +
           segment('\xc0', std::string("\x08\0\x08\0\x08\x01\x01\x11\0", 9)) + table('\0') +
           table('\x10') + segment('\xda', std::string("\1\1\0\0\x3f\0", 6)) + "\x3f\xff\xd9";
}

/// What would be a Huffman table of more than 256 codes.
const std::string kNoTable = "\xff\xc4" + std::string("\x07\0\0", 3) + std::string(40, '\xff');

int texels(const std::string& bytes) {
    std::string cause;
    const Texture texture = decodeTexture(bytes, cause);
    EXPECT_EQ(texture.rgba.empty(), !cause.empty());
    if (!texture.rgba.empty()) {
        EXPECT_NEAR(texture.rgba[0], 128, 1);
    }
    return texture.width * texture.height;
}

TEST(JpegBytes, BehindTheEndAreNoPartOfIt) {
    EXPECT_EQ(texels(jpeg()), 64);
    EXPECT_EQ(texels(jpeg() +
                     std::string("\0\0\0\x18"
                                 "ftypmp42",
                                 12) +
                     kNoTable),
              64);
    EXPECT_EQ(texels(jpeg() + jpeg()), 64);
}

TEST(JpegBytes, WithinOtherSegmentsAreNoTables) {
    EXPECT_EQ(texels(jpeg(segment('\xe1', kNoTable))), 64);
    EXPECT_EQ(texels(jpeg(segment('\xfe', kNoTable))), 64);
    EXPECT_EQ(texels(jpeg(kNoTable)), 0) << "control: a table";
}

TEST(PngBytes, BehindTheEndAreNoPartOfIt) {
    const TemporaryFolder folder;
    writePng(folder.path() / "a.png", {1, 1, {Rgb(0.2158605f)}}, 0);
    const std::string png = readBytes(folder.path() / "a.png");
    EXPECT_EQ(texels(png), 1);
    EXPECT_EQ(texels(png + "\xde\xad\xbe\xef and more"), 1);
    EXPECT_EQ(texels(png.substr(0, png.size() - 13) + "\xff\xff\xff\xff" + "IDAT"), 0) << "control";
}

}  // namespace
}  // namespace shadowcache::test
