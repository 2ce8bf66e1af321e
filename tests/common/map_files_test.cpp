#include "tests/support/map_files.h"

#include <OpenEXR/ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/image/radiance.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

std::filesystem::path caseFile(const std::string& name) {
    return std::filesystem::path(SHADOWCACHE_CASES) / name;
}

/// Radiance of a white Lambertian floor under the whole map, nothing in the way.
Rgb floorUnder(const Image& map) {
    Rgb sum(0.0f);
    for (int y = 0; y < map.height; ++y) {
        const auto sine = [&](int row) { return std::sin(M_PI * row / map.height); };
        if (2 * y >= map.height) break;
        const double cosines = (std::pow(sine(y + 1), 2) - std::pow(sine(y), 2)) / 2;
        const double weight = cosines * 2 / map.width;
        for (int x = 0; x < map.width; ++x)
            sum += map.pixels[static_cast<std::size_t>(y * map.width + x)] *
                   static_cast<float>(weight);
    }
    return sum;
}

void expectFloor(const std::string& name, const Rgb& wanted) {
    const Rgb found = floorUnder(readRadiance(caseFile(name)).image);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], wanted[k], 2e-3f * wanted[k]) << name;
}

TEST(MapCases, GiveTheFloorItsLight) {
    for (const char* name : {"sun_full.exr", "crop_sun.exr"}) expectFloor(name, Rgb(4.42f));
    for (const char* name : {"sun_max.exr", "sun_inf.exr"}) expectFloor(name, Rgb(783.4f));
    for (const char* name : {"full.exr", "crlf.hdr", "oldrle.hdr", "xfirst.hdr"})
        expectFloor(name, {0, 0.5f, 0.5f});
}

TEST(MapCases, HoldTheSameMaps) {
    const auto pixels = [](const std::string& name) {
        return readRadiance(caseFile(name)).image.pixels;
    };
    for (const char* name : {"crlf.hdr", "oldrle.hdr", "xfirst.hdr"})
        EXPECT_EQ(pixels(name), pixels("full.exr")) << name;
    EXPECT_EQ(pixels("crop_sun.exr"), pixels("sun_full.exr"));
    EXPECT_EQ(pixels("sun_inf.exr"), pixels("sun_max.exr"));
    EXPECT_GT(readRadiance(caseFile("sun_inf.exr")).infinite, 0u);
    expectError([] { readRadiance(caseFile("cube.exr")); }, "cube.exr",
                "envmap = cube, expected a lat-long map");
}

const Imath::Box2i kDisplay({10, -3}, {17, 0});  // 8 x 4

/// The first channel, row by row, of a map whose channels are R, G and B of these windows.
std::vector<float> redOf(const RadianceImage& map) {
    std::vector<float> red;
    for (const Rgb& pixel : map.image.pixels) red.push_back(pixel.x);
    return red;
}

TEST(MapWindows, TheMapCoversTheDisplayWindow) {
    const TemporaryFolder folder;
    const std::vector<Imath::Box2i> windows{
        kDisplay,                           // as large
        Imath::Box2i({12, -2}, {14, -1}),   // within
        Imath::Box2i({4, -9}, {30, 12}),    // overscan all around
        Imath::Box2i({14, -20}, {40, -2}),  // over the upper right corner
        Imath::Box2i({-5, -1}, {11, 5})};   // over the lower left one
    for (std::size_t i = 0; i < windows.size(); ++i) {
        const Imath::Box2i& data = windows[i];
        const auto path = folder.path() / "a.exr";
        writeMapParts(path, {mapPart(kDisplay, data, {{"R", 1}, {"G", 2}, {"B", 3}})});
        const RadianceImage map = readRadiance(path);
        ASSERT_EQ(map.image.width, 8);
        ASSERT_EQ(map.image.height, 4);
        for (int y = 0; y < 4; ++y)
            for (int x = 0; x < 8; ++x) {
                const bool there =
                    data.intersects(Imath::V2i(kDisplay.min.x + x, kDisplay.min.y + y));
                const float value = 1.0f + static_cast<float>(x) + 100.0f * static_cast<float>(y);
                const Rgb wanted = there ? Rgb(value, value + 1, value + 2) : Rgb(0.0f);
                EXPECT_EQ(map.image.pixels[static_cast<std::size_t>(8 * y + x)], wanted)
                    << i << ": " << x << "," << y;
            }
        EXPECT_EQ(map.notes.empty(), i == 0);
    }
}

TEST(MapWindows, OfEachPartAreItsOwn) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.exr";
    writeMapParts(path, {mapPart(kDisplay, kDisplay, {{"Z", 9}}, "depth"),
                         mapPart(kDisplay, Imath::Box2i({12, -2}, {12, -2}),
                                 {{"R", 1}, {"G", 1}, {"B", 1}}, "beauty")});
    std::vector<float> wanted(32, 0.0f);
    wanted[8 + 2] = 1 + 2 + 100;
    EXPECT_EQ(redOf(readRadiance(path)), wanted);
}

TEST(MapWindows, WithoutAPixelInTheDisplayWindowAreRefused) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.exr";
    writeMapParts(path, {mapPart(kDisplay, Imath::Box2i({18, -3}, {20, 0}), {{"Y", 1}})});
    expectError([&] { readRadiance(path); }, "a.exr", "outside of the display window of 8x4");
}

TEST(MapWindows, OfNoFileThatSizeAreRefused) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.exr";
    for (const int side : {20000, 1 << 29}) {
        writeMapParts(path, {mapPart(Imath::Box2i({0, 0}, {side - 1, side - 1}),
                                     Imath::Box2i({0, 0}, {1, 1}), {{"Y", 1}})});
        expectError([&] { readRadiance(path); }, "a.exr", "display window of");
    }
}

/// What is read of a file of one part with these channels, each of its own value.
RadianceImage readLayers(const std::vector<std::string>& names, bool views = false) {
    const TemporaryFolder folder;
    std::vector<std::pair<std::string, float>> channels;
    for (const std::string& name : names)
        channels.emplace_back(name, 1000.0f * static_cast<float>(channels.size() + 1));
    MapPart part = mapPart(kDisplay, kDisplay, channels);
    if (views) Imf::addMultiView(part.header, {"right", "left"});
    writeMapParts(folder.path() / "a.exr", {part});
    return readRadiance(folder.path() / "a.exr");
}

void expectLayer(const std::vector<std::string>& names, const Rgb& first, const std::string& note,
                 bool views = false) {
    const RadianceImage map = readLayers(names, views);
    EXPECT_EQ(map.image.pixels[0], first) << note;
    ASSERT_EQ(map.notes.size(), note.empty() ? 0u : 1u) << names[0];
    if (!note.empty()) {
        EXPECT_EQ(map.notes[0], note);
    }
}

TEST(MapLayers, AsOtherProgramsWriteThemAreRead) {
    const Rgb three(1000, 2000, 3000);
    // Blender, Nuke, and names in small letters.
    expectLayer({"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B",
                 "ViewLayer.Combined.A", "ViewLayer.Depth.Z"},
                three, "colours of the layer ViewLayer.Combined");
    expectLayer({"rgba.red", "rgba.green", "rgba.blue", "rgba.alpha"}, three,
                "colours of the layer rgba");
    expectLayer({"RGBA.R", "RGBA.G", "RGBA.B"}, three, "colours of the layer RGBA");
    expectLayer({"left.R", "left.G", "left.B"}, three, "colours of the layer left");
    expectLayer({"r", "g", "b"}, three, "");
    expectLayer({"C.r", "C.g", "C.b", "A"}, three, "colours of the layer C");
}

TEST(MapLayers, TheMainOneOfSeveralIsReadAndNamed) {
    const Rgb last(4000, 5000, 6000);
    expectLayer({"ViewLayer.DiffCol.R", "ViewLayer.DiffCol.G", "ViewLayer.DiffCol.B",
                 "ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B"},
                last, "colours of the layer ViewLayer.Combined, of 2");
    expectLayer({"left.R", "left.G", "left.B", "right.R", "right.G", "right.B"}, last,
                "colours of the layer right, of 2", true);
    expectLayer({"albedo.R", "albedo.G", "albedo.B", "R", "G", "B"}, last, "");
    // A part's Y is luminance, and beside X a coordinate.
    expectLayer({"a.R", "a.G", "a.B", "Y"}, Rgb(4000), "");
    expectLayer({"a.R", "a.G", "a.B", "X", "Y", "Z"}, {1000, 2000, 3000}, "colours of the layer a");
}

TEST(MapLayers, OfWhichNoneIsTheMainOneAreRefusedByName) {
    const auto refused = [](const std::vector<std::string>& names, const std::string& cause) {
        expectError([&] { readLayers(names); }, "a.exr", cause);
    };
    refused({"left.R", "left.G", "left.B", "right.R", "right.G", "right.B"},
            "colours in 2 layers (left, right), expected R, G, B or one such layer");
    refused({"a.R", "a.G", "b.B"}, "channels a.G, a.R, b.B, expected");
    refused({"N.X", "N.Y", "N.Z"}, "channels N.X, N.Y, N.Z, expected");
}

TEST(MapLayers, TheFirstOfPartsWithColoursIsNamed) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.exr";
    writeMapParts(path, {mapPart(kDisplay, kDisplay, {{"Y", 7}}, "mask"),
                         mapPart(kDisplay, kDisplay, {{"R", 1}, {"G", 1}, {"B", 1}}, "beauty"),
                         mapPart(kDisplay, kDisplay, {{"R", 5}, {"G", 5}, {"B", 5}}, "glossy")});
    const RadianceImage map = readRadiance(path);
    EXPECT_EQ(map.image.pixels[0], Rgb(1.0f));
    EXPECT_EQ(map.notes, std::vector<std::string>{
                             "colours of part 'beauty', the first of 2 parts that have some"});
}

}  // namespace
}  // namespace shadowcache::test
