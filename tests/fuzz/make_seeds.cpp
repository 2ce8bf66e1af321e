// Writes the first files of each corpus, and what dictionaries have of the options' table:
// fuzz_seeds SEEDS DICTIONARIES.

#include "tests/fuzz/make_seeds.h"

#include <fmt/core.h>

#include <cstdio>

#include "bake/shot/lookup_file.h"
#include "common/base/report_failure.h"
#include "common/cache/cache_items.h"
#include "common/image/exr.h"
#include "render/library/option_table.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache {

namespace fs = std::filesystem;

void writeSeed(const fs::path& path, const std::string& bytes) {
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << bytes;
}

namespace {

void writePictures(const fs::path& folder) {
    const std::vector<float> values(24, 0.75f);
    for (const PixelType type : {PixelType::half, PixelType::full}) {
        const std::string name = type == PixelType::half ? "half" : "full";
        const test::TemporaryFolder work;
        writeExr(work.path() / "a.exr", 6, 4, {{"R", values}, {"G", values}, {"B", values}},
                 {{"shadowcache:version", "1"}}, type);
        for (const std::string kind : {"exr/", "reference/"})
            writeSeed(folder / (kind + name), test::readBytes(work.path() / "a.exr"));
    }
    const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n";
    writeSeed(folder / "hdr/flat", head + "-Y 2 +X 2\n" + std::string(16, '\x81'));
    std::string row("\2\2\0\x08", 4);
    for (int channel = 0; channel < 4; ++channel) row += "\x88\x81";
    writeSeed(folder / "hdr/coded", head + "-Y 2 +X 8\n" + row + row);
    writeSeed(folder / "hdr/runs",
              "#?X\r\nCOLORCORR=1 2 .5\r\nFORMAT= 32-bit_rle_rgbe\r\n\r\n+X 2 +Y 9\r\n" +
                  std::string("\x80\x40\x20\x81\1\1\1\7\2\2\x80\x81", 12) +
                  std::string("\2\2\x80\x81\1\1\1\0\1\1\1\0\x80\0\0\x81\1\1\1\7", 20));
}

/// What a fuzzer of options tries, beside the words of tests/fuzz/dictionaries.
///
/// @param before, after  around the name that an option has at the door
void writeDictionary(const fs::path& path, Door door, const std::string& before,
                     const std::string& after) {
    std::string text;
    for (const OptionRow& row : optionTable()) {
        if (!row.isAt(door) || row.isPositional) continue;
        text += "\"" + before + row.nameAt(door) + after + "\"\n";
        for (const std::string& choice : row.choices) text += "\"" + choice + "\"\n";
    }
    writeSeed(path, text);
}

void writeDictionaries(const fs::path& folder) {
    writeDictionary(folder / "render_words", Door::commandLine, "--", "");
    writeDictionary(folder / "render_settings", Door::commandLine, "", "");
    writeDictionary(folder / "request", Door::serve, "\\\"", "\\\"");
}

void writeTexts(const fs::path& folder) {
    writeSeed(folder / "camera/one",
              R"({"version":1,"cam":{"yfov":0.9,"fps":12,"frames":[{"origin":[0.5,1e3,2],)"
              R"("forward":[0,-0.5,-1],"up":[0,1,0]}]}})");
    writeSeed(folder / "track/one", R"({"frames":[{"translation":[1,0,0],"rotation":[0,0,0,1],)"
                                    R"("scale":[1,2,1e2]},{}]})");
    writeSeed(
        folder / "words/bake",
        "set.obj\n-o\nset.vdb\n--spacing=0.5\n--level\n3\n--shard\n2/8\n--camera\na.json\n"
        "--size\n64x48\n--dynamic\na.ply@b.json\n--seed\n7\n--up\nz\n--threads=2\n--estimate\n");
    const auto request = [&](const std::string& name, const std::string& fields) {
        writeSeed(folder / "request" / name,
                  R"({"id":1,"request":")" + name + "\"," + fields + "}");
    };
    request("load", R"("set":["a.glb"],"cache":"a.vdb","up":"z","scale":0.1,"set-frame":3,)"
                    R"("surfaces":"diffuse","smooth":30,"dynamic":["d.glb@t.json"])");
    request("lamps", R"("lamp":["desk*=2,1,0.5","*=0"])");
    request("environment", R"("map":"m.exr","rotate":[1,0,0,0,1,0,0,0,1],"gain":[1,2,3])");
    request("camera", R"("view":{"origin":[0,1,2],"forward":[0,0,-1],"up":[0,1,0],"yfov":0.9,)"
                      R"("lens":{"radius":0.1,"focus":3}})");
    request("size", R"("width":64,"height":36)");
    request("region", R"("x":1,"y":2,"width":8,"height":4)");
    request("options", R"("spp":4,"bounces":"all","aov":["depth"],"material":{"roughness":0.3},)"
                       R"("sequence":"random","albedo":[0.1,0.2,0.3],"filter":"box")");
    request("render", R"("pixels":"p","frame":-3,"progressive":true)");
    request("stop", R"("x":1)");
    writeSeed(folder / "words/other", "--help");
    writeSeed(folder / "words/man", "--man-page");
    writeSeed(folder / "words/completion", "--bash-completion");
    writeSeed(
        folder / "render_words/still",
        "set.ply\n--env\n1,0.5,2e-1\n--eye\n1,2,3\n--look-at\n0,0,0\n--size\n64x36\n--crop\n1,2,"
        "8x4\n"
        "--material\nroughness=0.3,metallic=1\n--estimator\nlights\n-o\na.exr\n--png");
    writeSeed(
        folder / "render_words/shot",
        "set.glb\n--env\nsky.####.exr\n--env-rotate\n10-90\n--camera\nshot\n--frames\n1-9x2,12\n-"
        "-cache\n"
        "set.vdb\n--memory\n4.5G\n--spp\n64\n--aov\ndepth\nitems\n-o\na.%04d.exr\n--resume");
    writeSeed(
        folder / "render_settings/toml",
        "env='sky.exr'\nframes='1-9'\nsize='8x6'\nsamples=4\naov=['depth','items']\nmaterial='"
        "ior=1.5'\n");
    writeSeed(
        folder / "settings/toml",
        "spacing = 0.5\nlevel=3\nuniform=true\ndynamic=[\"a.ply\", \"b.ply@c.json\"]\nup=\"z\"\n"
        "camera='shot_010'\nseed=7\n# comment\n");
}

void writeCaches(const fs::path& folder) {
    const test::TemporaryFolder work;
    for (const int level : {0, 3}) {
        CacheHeader header;
        header.level = level;
        header.spacing = 0.5;
        header.bakes = {{1, 16, 1, {{0, 0}}}};
        header.upAxis = "y";
        header.version = "0";
        CacheItems items;
        const std::uint32_t cells = header.tiers().baseCells();
        for (int i = 0; i < 3; ++i) {
            items.voxel.emplace_back(i, 0, 0);
            items.patch.push_back(static_cast<std::int16_t>(125 * 4 * 2));
            items.normal.emplace_back(0, 1, 0);
            items.position.emplace_back(0, 0, 0);
            items.n.insert(items.n.end(), cells, 3);
            items.d.insert(items.d.end(), cells, static_cast<std::uint8_t>(4 + i));
            if (level > 1) items.blocks.push_back({5, {}, {}});
            items.firstBlock.push_back(static_cast<std::uint32_t>(items.blocks.size()));
        }
        writeCache(work.path() / "a.vdb", header, items);
        for (const std::string kind : {"whole", "paged"})
            writeSeed(folder / ("cache_" + kind) / fmt::format("level{}", level),
                      test::readBytes(work.path() / "a.vdb"));
    }
}

/// The files of other writers, each for the fuzzer of its extension.
void writeCases(const fs::path& folder) {
    for (const auto& entry : fs::directory_iterator(SHADOWCACHE_CASES))
        if (const std::string extension = entry.path().extension().string(); extension.size() > 1)
            writeSeed(folder / extension.substr(1) / entry.path().filename(),
                      test::readBytes(entry.path()));
}

void writeShotLookups(const fs::path& folder) {
    const test::TemporaryFolder work;
    ShotLookups lookups{0.5, 5, {8, 9, 10}, {}};
    lookups.places.add({{1, 2}, {1, 700}, {std::uint64_t{1} << 40, 3}});
    writeLookups(work.path() / "a.lookups", {{"version", "1"}}, lookups);
    // The fuzzer adds the checksum.
    std::string bytes = test::readBytes(work.path() / "a.lookups");
    bytes.resize(bytes.size() - sizeof(std::uint64_t));
    writeSeed(folder / "lookups/three", bytes);
}

}  // namespace
}  // namespace shadowcache

int main(int argc, char** argv) try {
    using namespace shadowcache;
    if (argc != 3) throw Error("expected the folders of seeds and of dictionaries to write");
    writeImportSeeds(argv[1]);
    writePictures(argv[1]);
    writeTexts(argv[1]);
    writeCaches(argv[1]);
    writeShotLookups(argv[1]);
    writeCases(argv[1]);
    writeDictionaries(argv[2]);
} catch (const std::exception& e) {
    return shadowcache::reportFailure("fuzz_seeds", e);
}
