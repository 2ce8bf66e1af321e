// Radiance HDR: eight orientations in three codings, headers of other writers, exposures, scan
// lines that begin 02 02; cut and hostile files are refused.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "common/image/radiance.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

std::string hdr(const std::string& lines, int width, int height, const std::string& texels) {
    return fmt::format("#?RADIANCE\n{}\n-Y {} +X {}\n{}", lines, height, width, texels);
}

TEST(Hdr, ReadsFlatTexelsAndExposure) {
    const TemporaryFolder folder;
    // Mantissas 128, 64, 32 with exponent 129 are 1, 0.5, 0.25.
    const std::string texel = "\x80\x40\x20\x81";
    const auto path =
        folder.write("a.hdr", hdr("FORMAT=32-bit_rle_rgbe\nEXPOSURE= 2.0\n", 2, 1, texel + texel));
    const RadianceImage read = readRadiance(path);
    ASSERT_EQ(read.image.pixels.size(), 2u);
    EXPECT_EQ(read.image.pixels[1], Rgb(0.5f, 0.25f, 0.125f));
}

/// Two rows of eight texels (1, 0.5, 0.25), one in runs and one spelt out.
std::string codedHdr() {
    const std::string mark("\2\2\0\10", 4);
    const std::string runs = mark + "\x88\x80\x88\x40\x88\x20\x88\x81";
    std::string spelt = mark;
    for (const char value : {'\x80', '\x40', '\x20', '\x81'})
        spelt += '\10' + std::string(8, value);
    return hdr("FORMAT=32-bit_rle_rgbe\n", 8, 2, runs + spelt);
}

TEST(Hdr, ReadsRuns) {
    const TemporaryFolder folder;
    const RadianceImage read = readRadiance(folder.write("a.hdr", codedHdr()));
    ASSERT_EQ(read.image.pixels.size(), 16u);
    for (const Rgb& pixel : read.image.pixels) EXPECT_EQ(pixel, Rgb(1.0f, 0.5f, 0.25f));
}

TEST(Hdr, OtherFormatsAreRefused) {
    const TemporaryFolder folder;
    const std::string good = hdr("FORMAT=32-bit_rle_rgbe\n", 1, 1, "\x80\x80\x80\x81");
    const auto refused = [&](const std::string& from, const std::string& to,
                             const std::string& cause) {
        std::string bytes = good;
        bytes.replace(bytes.find(from), from.size(), to);
        expectError([&] { readRadiance(folder.write("a.hdr", bytes)); }, "a.hdr", cause);
    };
    readRadiance(folder.write("a.hdr", good));
    refused("FORMAT=32-bit_rle_rgbe\n", "", "no FORMAT before");
    refused("rgbe", "xyze", "FORMAT=32-bit_rle_xyze (CIE XYZ), expected FORMAT=32-bit_rle_rgbe");
    refused("FORMAT=", "FORMAT =", "no FORMAT before");
    refused("-Y 1 +X 1", "-Y 1 +Y 1", "line 4: resolution axis '+Y'");
    refused("-Y 1 +X 1", "Y 1 +X 1", "resolution axis 'Y'");
    refused("-Y 1 +X 1", "-Y 0 +X 1", "side of 0 pixels, expected 1 to");
    refused("-Y 1 +X 1", "-Y 1 +X 16777217", "side of 16777217 pixels");
    refused("-Y 1 +X 1", "-Y 90000 +X 90000", "damaged or too large");
}

TEST(Hdr, EveryCutOffFileIsRefused) {
    const TemporaryFolder folder;
    const std::string whole = codedHdr();
    for (std::size_t length = 1; length < whole.size(); ++length) {
        const auto path = folder.write("a.hdr", whole.substr(0, length));
        EXPECT_THROW(readRadiance(path), Error) << length;
    }
}

/// Only an empty line ends the header.
TEST(Hdr, HeadersMayHoldAnything) {
    const TemporaryFolder folder;
    const std::string texel = "\x80\x40\x20\x81";
    const auto read = [&](const std::string& bytes) {
        return readRadiance(folder.write("a.hdr", bytes)).image.pixels.at(0);
    };
    const Rgb wanted(1, 0.5f, 0.25f);
    EXPECT_EQ(read("#?PICTURE\n \n# made\n\v\nFORMAT= 32-bit_rle_rgbe \n-Y 9 +X 9\n\n-Y 1 +X 1\n" +
                   texel),
              wanted);
    EXPECT_EQ(read("#?AUTOPANO\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 1 +X 1\r\n" + texel), wanted);
    // Of a picture that another was made of: not this one's.
    EXPECT_EQ(
        read(hdr("FORMAT=32-bit_rle_rgbe\n\tEXPOSURE=8\n\tFORMAT=32-bit_rle_xyze\n", 1, 1, texel)),
        wanted);
}

TEST(Hdr, DividesByEveryExposureAndColorCorrection) {
    const TemporaryFolder folder;
    const std::string texel = "\x80\x40\x20\x81";
    const auto read = [&](const std::string& lines) {
        return readRadiance(
                   folder.write("a.hdr", hdr("FORMAT=32-bit_rle_rgbe\n" + lines, 1, 1, texel)))
            .image.pixels.at(0);
    };
    EXPECT_EQ(read("EXPOSURE=2\nEXPOSURE=\t0.25\n"), Rgb(2, 1, 0.5f));
    EXPECT_EQ(read("COLORCORR= 2 1 0.5\nEXPOSURE=4\nCOLORCORR=1 .5 1\n"),
              Rgb(0.125f, 0.25f, 0.125f));
    for (const std::string bad :
         {"EXPOSURE=0", "EXPOSURE=-1", "EXPOSURE=nan", "EXPOSURE=inf",
          "EXPOSURE=", "EXPOSURE=1e-300\nEXPOSURE=1e-300", "COLORCORR=1 1", "COLORCORR=1 0 1"})
        expectError([&] { read(bad + "\n"); }, "a.hdr", "expected");
    // Whatever overflows is as a texel of +Inf.
    EXPECT_EQ(read("EXPOSURE=1e-40\n"), Rgb(65504.0f));
}

TEST(Hdr, TellsOtherPrimariesAndKeepsThem) {
    const TemporaryFolder folder;
    const auto read = [&](const std::string& lines) {
        return readRadiance(folder.write(
            "a.hdr", hdr("FORMAT=32-bit_rle_rgbe\n" + lines, 1, 1, "\x80\x40\x20\x81")));
    };
    for (const std::string same :
         {"", "PRIMARIES=.64 .33 .3 .6 .15 .06 .3127 .329\n", "GAMMA=1.0\n", "PIXASPECT=2\n"}) {
        EXPECT_TRUE(read(same).notes.empty()) << same;
        EXPECT_FALSE(read(same).chromaticities) << same;
    }
    const RadianceImage aces = read("PRIMARIES= 0.7347 0.2653 0 1 0.0001 -0.077 0.32168 0.33767\n");
    ASSERT_TRUE(aces.chromaticities);
    EXPECT_EQ(aces.chromaticities->at(0), 0.7347f);
    EXPECT_EQ(aces.chromaticities->at(7), 0.33767f);
    EXPECT_NEAR(aces.luminanceWeights.x, 0.318f, 0.003f);
    EXPECT_EQ(aces.image.pixels[0], Rgb(1, 0.5f, 0.25f));
    ASSERT_EQ(aces.notes.size(), 1u);
    EXPECT_NE(aces.notes[0].find("not Rec. 709 but red 0.7347,0.2653"), std::string::npos);
    EXPECT_EQ(read("GAMMA=2.2\n").notes.at(0), "GAMMA of 2.2 is left out: texels are linear");
    for (const std::string bad : {"PRIMARIES=1 2 3", "PRIMARIES=red", "PRIMARIES=0 0 0 0 0 0 0 1e9",
                                  "PRIMARIES=nan 0 0 0 0 0 0 0", "GAMMA=", "GAMMA=two"})
        expectError([&] { read(bad + "\n"); }, "a.hdr", "line 3");
    expectError([&] { read("PRIMARIES=0 0 0 0 0 0 0 0\n"); }, "a.hdr",
                "primaries red 0,0, green 0,0, blue 0,0, white 0,0 have no luminance");
}

using Rgbe = std::array<std::uint8_t, 4>;

/// 9 x 8 texels, all different, each of one power of two.
Rgbe pixelAt(int x, int y) {
    return {128, 0, 0, static_cast<std::uint8_t>(100 + x + 9 * y)};
}

/// A scan line in one of three codings: flat, runs of pixels, runs by channel.
std::string coded(const std::vector<Rgbe>& line, int coding) {
    std::string bytes;
    if (coding < 2) {
        for (std::size_t x = 0; x < line.size(); ++x) {
            bytes.append(reinterpret_cast<const char*>(line[x].data()), 4);
            if (coding == 1 && x + 1 < line.size()) bytes += std::string("\1\1\1\0", 4);
        }
        return bytes;
    }
    bytes = {2, 2, 0, static_cast<char>(line.size())};
    for (std::size_t channel = 0; channel < 4; ++channel)
        for (const Rgbe& pixel : line) bytes += {'\1', static_cast<char>(pixel[channel])};
    return bytes;
}

TEST(Hdr, ReadsAllOrientationsInAllCodings) {
    const TemporaryFolder folder;
    constexpr int kWidth = 9, kHeight = 8;
    std::vector<Rgb> wanted;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            wanted.emplace_back(std::ldexp(1.0f, pixelAt(x, y)[3] - 129), 0.0f, 0.0f);
    for (int which = 0; which < 8; ++which)
        for (int coding = 0; coding < 3; ++coding) {
            const bool columns = (which & 1) != 0, right = (which & 2) != 0, up = (which & 4) != 0;
            const std::string across = fmt::format("{}X {}", right ? "-" : "+", kWidth);
            const std::string down = fmt::format("{}Y {}", up ? "+" : "-", kHeight);
            std::string bytes = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" +
                                (columns ? across + " " + down : down + " " + across) + "\n";
            for (int i = 0; i < (columns ? kWidth : kHeight); ++i) {
                std::vector<Rgbe> line;
                for (int k = 0; k < (columns ? kHeight : kWidth); ++k) {
                    const int x = columns ? i : k, y = columns ? k : i;
                    line.push_back(pixelAt(right ? kWidth - 1 - x : x, up ? kHeight - 1 - y : y));
                }
                bytes += coded(line, coding);
            }
            EXPECT_EQ(readRadiance(folder.write("a.hdr", bytes)).image.pixels, wanted)
                << which << " in coding " << coding;
        }
}

/// [Radiance's color.c: MINELEN, MAXELEN and freadcolrs]
TEST(Hdr, ScanLinesThatBeginWith2And2) {
    const TemporaryFolder folder;
    const auto read = [&](int width, const std::string& texels) {
        return readRadiance(
                   folder.write("a.hdr", hdr("FORMAT=32-bit_rle_rgbe\n", width, 1, texels)))
            .image.pixels;
    };
    const auto flat = [](int width, const std::string& first) {
        std::string bytes;
        for (int x = 0; x < width; ++x) bytes += first;
        return bytes;
    };
    const auto value = [](int mantissa) { return std::ldexp(static_cast<float>(mantissa), -8); };
    // Too short, and too long, for runs by channel; and a third byte that no such line has.
    EXPECT_EQ(read(7, flat(7, "\2\2\x07\x80")).at(6), Rgb(value(2), value(2), value(7)));
    EXPECT_EQ(read(32768, flat(32768, "\2\2\x08\x80")).at(32767),
              Rgb(value(2), value(2), value(8)));
    EXPECT_EQ(read(8, flat(8, "\2\2\x80\x80")).at(7), Rgb(value(2), value(2), value(128)));
    // The length of another line.
    expectError([&] { read(8, flat(8, std::string("\2\2\0\x09", 4))); }, "a.hdr",
                "scan line 0 of 1 is not whole");
    // Each line is of its own kind.
    const std::string one = flat(8, "\x80\x40\x20\x81");
    std::string runs("\2\2\0\10", 4);
    runs += "\x88\x80\x88\x40\x88\x20\x88\x81";
    const auto both = readRadiance(
        folder.write("b.hdr", hdr("FORMAT=32-bit_rle_rgbe\n", 8, 3, one + runs + one)));
    for (const Rgb& pixel : both.image.pixels) EXPECT_EQ(pixel, Rgb(1, 0.5f, 0.25f));
}

TEST(Hdr, RunsOfPixelsAreCountedInDigitsOf256) {
    const TemporaryFolder folder;
    const auto read = [&](int width, const std::string& texels) {
        return readRadiance(
                   folder.write("a.hdr", hdr("FORMAT=32-bit_rle_rgbe\n", width, 1, texels)))
            .image.pixels;
    };
    const std::string one = "\x80\x80\x80\x81", two = "\x80\x80\x80\x82", repeat = "\1\1\1";
    const std::string zero(1, '\0');
    // 3 + 2 * 256 times, then another pixel and a run that counts from 1 again.
    const auto pixels =
        read(1 + 3 + 512 + 1 + 2, one + repeat + "\3" + repeat + "\2" + two + repeat + "\2");
    EXPECT_EQ(pixels.at(515), Rgb(1.0f));
    EXPECT_EQ(pixels.at(516), Rgb(2.0f));
    EXPECT_EQ(pixels.at(518), Rgb(2.0f));
    // Nothing to repeat, more than the line has, and more digits than a number holds.
    for (const std::string& bad :
         {repeat + "\3" + one, one + repeat + "\4",
          one + repeat + zero + repeat + zero + repeat + zero + repeat + zero + repeat + "\1"})
        expectError([&] { read(4, bad); }, "a.hdr", "scan line 0 of 1 is not whole");
}

}  // namespace
}  // namespace shadowcache::test
