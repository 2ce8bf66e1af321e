// EXR, HDR and PNG: layouts, channels, chromaticities, repaired texels, truncated files.

#include "common/image/image.h"

#include <OpenEXR/ImfArray.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTiledRgbaFile.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#include <stb/stb_image.h>

#include "common/image/exr.h"
#include "common/image/png.h"
#include "common/image/radiance.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

constexpr int kWidth = 16;
constexpr int kHeight = 8;

/// Smooth picture, so that subsampled chroma can be compared, too.
Rgb texel(int x, int y) {
    const auto u = static_cast<float>(x) / 16.0f;
    const auto v = static_cast<float>(y) / 8.0f;
    return {1.0f + u, 1.0f + v, 2.0f + 0.5f * u * v};
}

std::vector<Imf::Rgba> rgbaTexels() {
    std::vector<Imf::Rgba> texels;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            texels.emplace_back(texel(x, y).x, texel(x, y).y, texel(x, y).z, 0.5f);
        }
    }
    return texels;
}

void expectTexels(const std::filesystem::path& path, double tolerance) {
    const RadianceImage read = readRadiance(path);
    ASSERT_EQ(read.image.width, kWidth);
    ASSERT_EQ(read.image.height, kHeight);
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const Rgb& found = read.image.pixels[static_cast<std::size_t>(y * kWidth + x)];
            for (int c = 0; c < 3; ++c) {
                ASSERT_NEAR(found[c], texel(x, y)[c], tolerance) << path << x << "," << y;
            }
        }
    }
}

std::vector<Channel> rgbChannels() {
    std::vector<Channel> channels{{"R", {}}, {"G", {}}, {"B", {}}};
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            for (int c = 0; c < 3; ++c) {
                channels[static_cast<std::size_t>(c)].values.push_back(texel(x, y)[c]);
            }
        }
    }
    return channels;
}

TEST(Exr, KeepsChannelsAndMetadata) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.exr";
    auto channels = rgbChannels();
    channels.push_back({"depth.Z", channels[0].values});
    channels[3].values[5] = -1e30f;
    writeExr(path, kWidth, kHeight, channels, {{"seed", "7"}, {"note", "two\nlines"}},
             PixelType::full);
    const ExrFile read = readExr(path);
    EXPECT_EQ(read.width, kWidth);
    EXPECT_EQ(read.height, kHeight);
    EXPECT_EQ(read.metadata.at("seed"), "7");
    EXPECT_EQ(read.metadata.at("note"), "two\nlines");
    ASSERT_EQ(read.channels.size(), 4u);
    for (const Channel& channel : read.channels) {
        const auto same = [&](const Channel& c) { return c.name == channel.name; };
        const auto written = std::find_if(channels.begin(), channels.end(), same);
        ASSERT_NE(written, channels.end()) << channel.name;
        EXPECT_EQ(channel.values, written->values) << channel.name;
    }
    expectTexels(path, 0.0);
}

TEST(Exr, SaysHowItIsSeen) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.exr";
    ExrView view{
        .pixelAspect = 2,
        .screenCenter = {-0.25f, 0.5f},
        .screenWidth = 3,
        .framesPerSecond = 23.976,
        .chromaticities = Chromaticities{.68f, .32f, .265f, .69f, .15f, .06f, .314f, .351f}};
    view.worldToCamera.emplace().fill(1);
    view.worldToCamera->at(4) = 7;
    writeExr(path, 1, 1, {{"Y", {1.0f}}}, {}, PixelType::full, {}, view);
    const Imf::InputFile file(path.c_str());
    const Imf::Header& header = file.header();
    EXPECT_EQ(header.pixelAspectRatio(), 2);
    EXPECT_EQ(header.screenWindowCenter(), Imath::V2f(-0.25f, 0.5f));
    EXPECT_EQ(header.screenWindowWidth(), 3);
    EXPECT_EQ(Imf::worldToCamera(header)[1][0], 7);
    EXPECT_FALSE(Imf::hasWorldToNDC(header));
    EXPECT_EQ(Imf::framesPerSecond(header), Imf::Rational(24000, 1001));
    EXPECT_EQ(Imf::chromaticities(header).green, Imath::V2f(.265f, .69f));
    // Without a view, as before.
    writeExr(path, 1, 1, {{"Y", {1.0f}}}, {}, PixelType::full);
    EXPECT_FALSE(Imf::hasFramesPerSecond(Imf::InputFile(path.c_str()).header()));
    EXPECT_FALSE(Imf::hasChromaticities(Imf::InputFile(path.c_str()).header()));
}

TEST(Radiance, NamesOtherPrimaries) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.exr";
    const Chromaticities p3{.68f, .32f, .265f, .69f, .15f, .06f, .3127f, .329f};
    Chromaticities rec709{.64f, .33f, .3f, .6f, .15f, .06f, .3127f, .329f};
    const auto write = [&](const std::optional<Chromaticities>& colors) {
        writeExr(path, 2, 1, {{"R", {1, 1}}, {"G", {1, 1}}, {"B", {1, 1}}}, {}, PixelType::full, {},
                 {.chromaticities = colors});
        return readRadiance(path);
    };
    const RadianceImage wide = write(p3);
    EXPECT_EQ(wide.chromaticities, p3);
    ASSERT_EQ(wide.notes.size(), 1u);
    EXPECT_NE(wide.notes[0].find("not Rec. 709 but red 0.68,0.32"), std::string::npos);
    rec709[6] += 1e-5f;
    EXPECT_FALSE(write(rec709).chromaticities);
    EXPECT_TRUE(write(rec709).notes.empty());
    EXPECT_FALSE(write(std::nullopt).chromaticities);
}

TEST(Exr, HalfKeepsFiniteValuesFinite) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.exr";
    writeExr(path, 4, 1, {{"Y", {1.5f, 1e6f, -1e6f, -0.25f}}}, {}, PixelType::half);
    EXPECT_EQ(readExr(path).channels[0].values,
              (std::vector<float>{1.5f, 65504.0f, -65504.0f, -0.25f}));
}

TEST(Exr, RefusesChannelsOfAnotherSize) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.exr";
    expectError(
        [&] {
            writeExr(path, 3, 3, {{"Y", {1.0f}}}, {}, PixelType::half);
        },
        "a.exr", "expected width * height");
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Radiance, ReadsAnyWindowLayoutAndChannelSet) {
    const TemporaryFolder folder;
    const auto texels = rgbaTexels();
    const auto write = [&](const std::string& name, Imf::RgbaChannels channels) {
        const Imath::Box2i window({-6, 20}, {-6 + kWidth - 1, 20 + kHeight - 1});
        const auto path = folder.path() / name;
        Imf::RgbaOutputFile file(path.c_str(), window, window, channels);
        file.setFrameBuffer(texels.data() + 6 - 20 * kWidth, 1, kWidth);
        file.writePixels(kHeight);
        return path;
    };
    expectTexels(write("rgba.exr", Imf::WRITE_RGBA), 2e-3);
    expectTexels(write("chroma.exr", Imf::WRITE_YC), 0.15);

    const Image luma = readRadiance(write("y.exr", Imf::WRITE_Y)).image;
    EXPECT_NEAR(luma.pixels[20].x, luminance(texel(4, 1)), 2e-3f);
    EXPECT_EQ(luma.pixels[20].x, luma.pixels[20].z);

    const auto tiled = folder.path() / "tiled.exr";
    {
        Imf::TiledRgbaOutputFile file(tiled.c_str(), kWidth, kHeight, 5, 3, Imf::MIPMAP_LEVELS);
        for (int level = 0; level < file.numLevels(); ++level) {
            file.setFrameBuffer(texels.data(), 1, kWidth);
            file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
        }
    }
    expectTexels(tiled, 2e-3);
}

TEST(Radiance, TakesTheFirstPartWithColorAndAnyNumberType) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "parts.exr";
    std::vector<Imf::Header> headers;
    for (const char* name : {"mask", "beauty"}) {
        Imf::Header header(kWidth, kHeight);
        header.setName(name);
        header.setType(Imf::SCANLINEIMAGE);
        headers.push_back(header);
    }
    headers[0].channels().insert("Z", Imf::Channel(Imf::FLOAT));
    for (const char* name : {"R", "G", "B"})
        headers[1].channels().insert(name, Imf::Channel(Imf::UINT));
    const std::vector<float> depth(kWidth * kHeight, 9.0f);
    const std::vector<unsigned> threes(kWidth * kHeight, 3);
    {
        Imf::MultiPartOutputFile file(path.c_str(), headers.data(), 2);
        for (int part = 0; part < 2; ++part) {
            Imf::FrameBuffer frame;
            for (auto c = headers[static_cast<std::size_t>(part)].channels().begin();
                 c != headers[static_cast<std::size_t>(part)].channels().end(); ++c) {
                const void* values = part == 0 ? static_cast<const void*>(depth.data())
                                               : static_cast<const void*>(threes.data());
                frame.insert(c.name(),
                             Imf::Slice::Make(c.channel().type, values, headers[0].dataWindow()));
            }
            Imf::OutputPart output(file, part);
            output.setFrameBuffer(frame);
            output.writePixels(kHeight);
        }
    }
    EXPECT_EQ(readRadiance(path).image.pixels[7], Rgb(3.0f, 3.0f, 3.0f));
}

TEST(Radiance, TakesLuminanceWeightsFromChromaticities) {
    const TemporaryFolder folder;
    const auto texels = rgbaTexels();
    const auto weightsOf = [&](const Imf::Chromaticities& primaries) {
        const auto path = folder.path() / "a.exr";
        Imf::Header header(kWidth, kHeight);
        Imf::addChromaticities(header, primaries);
        {
            Imf::RgbaOutputFile file(path.c_str(), header, Imf::WRITE_RGB);
            file.setFrameBuffer(texels.data(), 1, kWidth);
            file.writePixels(kHeight);
        }
        return readRadiance(path).luminanceWeights;
    };
    // ITU-R BT.2020: 0.2627, 0.6780, 0.0593.
    const Rgb wide =
        weightsOf({{0.708f, 0.292f}, {0.170f, 0.797f}, {0.131f, 0.046f}, {0.3127f, 0.329f}});
    EXPECT_NEAR(wide.x, 0.2627f, 1e-4f);
    EXPECT_NEAR(wide.y, 0.6780f, 1e-4f);
    // ACES AP0 has a blue of negative luminance; blue light must still count.
    const Rgb aces =
        weightsOf({{0.7347f, 0.2653f}, {0.0f, 1.0f}, {0.0001f, -0.077f}, {0.32168f, 0.33767f}});
    EXPECT_GT(aces.z, 0.0f);
    EXPECT_NEAR(aces.x + aces.y + aces.z, 1.0f, 1e-6f);
    expectError(
        [&] {
            weightsOf({{0.3f, 0}, {0.3f, 0}, {0.3f, 0}, {0.3f, 0}});
        },
        "a.exr", "primaries red 0.3,0, green 0.3,0, blue 0.3,0, white 0.3,0 have no luminance");
}

TEST(Radiance, NamesColorSpacesThatItDoesNotConvert) {
    const TemporaryFolder folder;
    const auto texels = rgbaTexels();
    const auto notes = [&](const char* attribute, const char* space, bool primaries) {
        const auto path = folder.path() / "a.exr";
        Imf::Header header(kWidth, kHeight);
        if (primaries) Imf::addChromaticities(header, {});
        header.insert(attribute, Imf::StringAttribute(space));
        {
            Imf::RgbaOutputFile file(path.c_str(), header, Imf::WRITE_RGB);
            file.setFrameBuffer(texels.data(), 1, kWidth);
            file.writePixels(kHeight);
        }
        return readRadiance(path).notes;
    };
    for (const char* attribute : {"colorInteropID", "oiio:ColorSpace"}) {
        EXPECT_TRUE(notes(attribute, "lin_rec709_scene", false).empty());
        EXPECT_TRUE(notes(attribute, "Linear", false).empty());
        EXPECT_TRUE(notes(attribute, "lin_ap1_scene", true).empty());
        for (const char* space : {"lin_ap1_scene", "ACEScg", "sRGB", "Filmic Log"}) {
            const std::vector<std::string> found = notes(attribute, space, false);
            ASSERT_EQ(found.size(), 1u) << space;
            EXPECT_EQ(
                found[0].find(std::string(attribute) + " is " + space + ", which is left out"), 0u)
                << found[0];
        }
        EXPECT_EQ(notes(attribute, "srgb_rec709_scene", true).size(), 1u);
    }
}

TEST(Radiance, OtherFilesAreRefusedByTheirKind) {
    const TemporaryFolder folder;
    using namespace std::string_literals;
    for (const auto& file : {std::pair("\x89PNG\r\n"s, "PNG"),
                             {"\xff\xd8\xff\xe0"s, "JPEG"},
                             {"MM\0*\0"s, "TIFF"},
                             {"\1\2\3\xfe\5"s, "a file of the bytes 01 02 03 fe ..."}})
        expectError([&] { readRadiance(folder.write("a.exr", file.first)); }, "a.exr",
                    "is neither OpenEXR nor Radiance HDR, but "s + file.second);
}

TEST(Radiance, MendsAndCountsBadTexels) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.exr";
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    writeExr(path, 5, 1,
             {{"R", {1, nan, 2, -1, 8e4f}}, {"G", {1, 1, inf, 2, 1}}, {"B", {1, 1, 1, -3, 1}}}, {},
             PixelType::full);
    const RadianceImage read = readRadiance(path);
    EXPECT_EQ(read.notANumber, 1u);
    EXPECT_EQ(read.infinite, 1u);
    EXPECT_EQ(read.negative, 1u);
    EXPECT_EQ(read.image.pixels,
              (std::vector<Rgb>{{1, 1, 1}, {0, 0, 0}, {2, 8e4f, 1}, {0, 2, 0}, {8e4f, 1, 1}}));
    EXPECT_EQ(read.notes,
              (std::vector<std::string>{"1 texels not a number and 1 negative, set to 0",
                                        "1 texels of +Inf, set to 80000"}));
}

TEST(Radiance, OfTexelsEndsWhereSumsOverflow) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.exr";
    const float inf = std::numeric_limits<float>::infinity();
    writeExr(path, 3, 1, {{"R", {1e25f, 1, 1e15f}}, {"G", {1, inf, 1}}, {"B", {1, 3e38f, 1}}}, {},
             PixelType::full);
    const RadianceImage read = readRadiance(path);
    EXPECT_EQ(read.image.pixels,
              (std::vector<Rgb>{{1e15f, 1, 1}, {1, 1e15f, 1e15f}, {1e15f, 1, 1}}));
    EXPECT_EQ(read.notes, (std::vector<std::string>{"1 texels of +Inf, set to 1e+15",
                                                    "1 texels above 1e+15, set to that"}));
}

TEST(Radiance, TellsHowMuchOfTheLightWasBelowZero) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.exr";
    writeExr(path, 2, 1, {{"R", {-1, 0}}, {"G", {1, 0}}, {"B", {2, 0}}}, {}, PixelType::full);
    EXPECT_EQ(readRadiance(path).notes,
              (std::vector<std::string>{
                  "0 texels not a number and 1 negative, set to 0, 25 % of the light"}));
}

TEST(Png, EncodesSrgb) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.png";
    const float nan = std::numeric_limits<float>::quiet_NaN();
    writePng(path, {2, 2, {{0.25f, 0.0f, 100.0f}, {-1.0f, nan, 0.05f}, {0, 0, 0}, {0.5f, 0, 0}}},
             1.0f);
    int width = 0;
    int height = 0;
    int channels = 0;
    const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> bytes(
        stbi_load(path.c_str(), &width, &height, &channels, 0), stbi_image_free);
    ASSERT_NE(bytes, nullptr);
    EXPECT_EQ(width, 2);
    EXPECT_EQ(height, 2);
    EXPECT_EQ(channels, 3);
    EXPECT_EQ(std::vector<int>(bytes.get(), bytes.get() + 12),
              (std::vector<int>{188, 0, 255, 0, 0, 89, 0, 0, 0, 255, 0, 0}));
}

}  // namespace
}  // namespace shadowcache::test
