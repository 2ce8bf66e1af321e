// The maps in `tests/cases` light a floor as they should; windows, layers, parts, tiles, lines
// in any order and number types of EXR; what is ambiguous, deep or subsampled is refused.

#include "tests/support/map_files.h"

#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineOutputPart.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <gtest/gtest.h>

#include <algorithm>
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
    for (const char* name : {"sun_whole.exr", "sun_in_smaller_data_window.exr"})
        expectFloor(name, Rgb(4.42f));
    for (const char* name : {"sun_greatest_number.exr", "sun_infinite.exr"})
        expectFloor(name, Rgb(783.4f));
    for (const char* name :
         {"whole_window.exr", "lines_end_in_crlf.hdr", "old_run_lengths.hdr", "columns_first.hdr"})
        expectFloor(name, {0, 0.5f, 0.5f});
}

TEST(MapCases, HoldTheSameMaps) {
    const auto pixels = [](const std::string& name) {
        return readRadiance(caseFile(name)).image.pixels;
    };
    for (const char* name : {"lines_end_in_crlf.hdr", "old_run_lengths.hdr", "columns_first.hdr"})
        EXPECT_EQ(pixels(name), pixels("whole_window.exr")) << name;
    EXPECT_EQ(pixels("sun_in_smaller_data_window.exr"), pixels("sun_whole.exr"));
    EXPECT_EQ(pixels("sun_infinite.exr"), pixels("sun_greatest_number.exr"));
    EXPECT_GT(readRadiance(caseFile("sun_infinite.exr")).infinite, 0u);
    expectError([] { readRadiance(caseFile("cube_map.exr")); }, "cube_map.exr",
                "envmap = cube, expected a lat-long map");
}

const Imath::Box2i kDisplay({10, -3}, {17, 0});  // 8 x 4

/// The first channel, row by row, of a map whose channels are R, G and B of these windows.
std::vector<float> redOf(const RadianceImage& map) {
    std::vector<float> red;
    for (const Rgb& pixel : map.image.pixels) red.push_back(pixel.x);
    return red;
}

// The data window is the whole map, says ImfEnvmap.h; what has no such attribute is a picture.
TEST(MapWindows, OfTheAttributeIsTheDataWindow) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.exr";
    const Imath::Box2i data({12, -2}, {15, -1});
    MapPart part = mapPart(kDisplay, data, {{"R", 1}, {"G", 2}, {"B", 3}});
    writeMapParts(path, {part});
    EXPECT_EQ(readRadiance(path).image.width, 8) << "control";
    Imf::addEnvmap(part.header, Imf::ENVMAP_LATLONG);
    writeMapParts(path, {part});
    const RadianceImage map = readRadiance(path);
    EXPECT_EQ(map.image.width, 4);
    EXPECT_EQ(map.image.height, 2);
    EXPECT_EQ(redOf(map), (std::vector<float>{103, 104, 105, 106, 203, 204, 205, 206}));
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

/// Fills a frame of one channel with 1 + column + 100 row.
std::vector<float> plane(const Imath::Box2i& window) {
    std::vector<float> values;
    for (int y = window.min.y; y <= window.max.y; ++y)
        for (int x = window.min.x; x <= window.max.x; ++x)
            values.push_back(1.0f + static_cast<float>(x - window.min.x) +
                             100.0f * static_cast<float>(y - window.min.y));
    return values;
}

Imf::Header headerOf(const Imf::Channel& channel, const char* name = "Y") {
    Imf::Header header(kDisplay, kDisplay);
    header.channels().insert(name, channel);
    return header;
}

TEST(MapLayouts, LinesInAnyOrderAndAnyNumbersAreRead) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.exr";
    const std::vector<float> wanted = plane(kDisplay);
    const std::vector<half> halves(wanted.begin(), wanted.end());
    const std::vector<unsigned> whole(wanted.begin(), wanted.end());
    for (const Imf::LineOrder order : {Imf::INCREASING_Y, Imf::DECREASING_Y})
        for (const Imf::PixelType type : {Imf::UINT, Imf::HALF, Imf::FLOAT}) {
            Imf::Header header = headerOf(Imf::Channel(type));
            header.lineOrder() = order;
            header.compression() = Imf::ZIP_COMPRESSION;
            const void* values = type == Imf::UINT   ? static_cast<const void*>(whole.data())
                                 : type == Imf::HALF ? static_cast<const void*>(halves.data())
                                                     : static_cast<const void*>(wanted.data());
            {
                Imf::OutputFile file(path.c_str(), header);
                Imf::FrameBuffer frame;
                frame.insert("Y", Imf::Slice::Make(type, values, kDisplay));
                file.setFrameBuffer(frame);
                file.writePixels(kDisplay.max.y - kDisplay.min.y + 1);
            }
            EXPECT_EQ(redOf(readRadiance(path)), wanted) << order << ' ' << type;
        }
}

TEST(MapLayouts, TilesAreReadAtTheirFullResolution) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.exr";
    const std::vector<float> wanted = plane(kDisplay);
    for (const Imf::LevelMode mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS, Imf::RIPMAP_LEVELS}) {
        Imf::Header header = headerOf(Imf::Channel(Imf::FLOAT));
        header.setTileDescription(Imf::TileDescription(3, 2, mode));
        {
            Imf::TiledOutputFile file(path.c_str(), header);
            for (int ly = 0; ly < file.numYLevels(); ++ly)
                for (int lx = 0; lx < file.numXLevels(); ++lx) {
                    if (!file.isValidLevel(lx, ly)) continue;
                    const Imath::Box2i window = file.dataWindowForLevel(lx, ly);
                    // Of the lower levels other numbers, which must not be read.
                    std::vector<float> values = plane(window);
                    if (lx + ly > 0) std::fill(values.begin(), values.end(), -7.0f);
                    Imf::FrameBuffer frame;
                    frame.insert("Y", Imf::Slice::Make(Imf::FLOAT, values.data(), window));
                    file.setFrameBuffer(frame);
                    file.writeTiles(0, file.numXTiles(lx) - 1, 0, file.numYTiles(ly) - 1, lx, ly);
                }
        }
        EXPECT_EQ(redOf(readRadiance(path)), wanted) << mode;
    }
}

TEST(MapLayouts, SubsampledColoursAreRefused) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.exr";
    Imf::Header header(8, 4);
    for (const char* name : {"R", "G", "B"})
        header.channels().insert(name, Imf::Channel(Imf::FLOAT, 2, 2));
    const std::vector<float> values(8, 1.0f);
    {
        Imf::OutputFile file(path.c_str(), header);
        Imf::FrameBuffer frame;
        for (const char* name : {"R", "G", "B"})
            frame.insert(name, Imf::Slice::Make(Imf::FLOAT, values.data(), header.dataWindow(),
                                                sizeof(float), 4 * sizeof(float), 2, 2));
        file.setFrameBuffer(frame);
        file.writePixels(4);
    }
    expectError([&] { readRadiance(path); }, "a.exr", "is subsampled, expected full resolution");
}

/// A deep part before a flat one is passed over; alone it is refused by name.
TEST(MapLayouts, DeepPartsAreNoMaps) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.exr";
    for (const bool alone : {true, false}) {
        std::vector<Imf::Header> headers{headerOf(Imf::Channel(Imf::FLOAT), "R"),
                                         headerOf(Imf::Channel(Imf::FLOAT))};
        for (const char* name : {"G", "B"})
            headers[0].channels().insert(name, Imf::Channel(Imf::FLOAT));
        headers[0].setType(Imf::DEEPSCANLINE);
        headers[0].setName("deep");
        headers[0].compression() = Imf::ZIPS_COMPRESSION;
        headers[1].setType(Imf::SCANLINEIMAGE);
        headers[1].setName("flat");
        const std::vector<unsigned> none(32, 0);
        const std::vector<float*> nowhere(32, nullptr);
        const std::vector<float> values = plane(kDisplay);
        {
            Imf::MultiPartOutputFile file(path.c_str(), headers.data(), alone ? 1 : 2);
            Imf::DeepFrameBuffer deep;
            deep.insertSampleCountSlice(Imf::Slice::Make(Imf::UINT, none.data(), kDisplay));
            for (const char* name : {"R", "G", "B"}) {
                const auto* base = reinterpret_cast<const char*>(nowhere.data()) -
                                   sizeof(float*) * static_cast<std::size_t>(10) +
                                   3 * 8 * sizeof(float*);
                deep.insert(name,
                            Imf::DeepSlice(Imf::FLOAT, const_cast<char*>(base), sizeof(float*),
                                           8 * sizeof(float*), sizeof(float)));
            }
            Imf::DeepScanLineOutputPart first(file, 0);
            first.setFrameBuffer(deep);
            first.writePixels(4);
            if (!alone) {
                Imf::FrameBuffer frame;
                frame.insert("Y", Imf::Slice::Make(Imf::FLOAT, values.data(), kDisplay));
                Imf::OutputPart second(file, 1);
                second.setFrameBuffer(frame);
                second.writePixels(4);
            }
        }
        if (alone)
            expectError([&] { readRadiance(path); }, "a.exr", "deep image with the channels");
        else
            EXPECT_EQ(redOf(readRadiance(path)), values);
    }
}

}  // namespace
}  // namespace shadowcache::test
