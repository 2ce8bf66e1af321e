// Writes the first files of each corpus: fuzz_seeds FOLDER.

#include <cstdio>

#include "bake/shot/lookup_file.h"
#include "common/base/report_failure.h"
#include "common/cache/cache_items.h"
#include "common/image/exr.h"
#include "common/image/png.h"
#include "tests/support/gltf_posed.h"
#include "tests/support/mesh_files.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& bytes) {
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << bytes;
}

void writeMeshes(const fs::path& folder) {
    using namespace test;
    write(folder / "obj/square", squareObj());
    write(folder / "obj/rich",
          "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 1 1 1\nvn 0 0 1\nvt 0 0\n"
          "f -4//1 -3//1 \\\n-2//1\nf 1/1/1 3/1/1 4/1/1\nf 1 2 3 4\ng a\ns 1\nusemtl b\n");
    write(folder / "obj/colors",
          "\xef\xbb\xbfv 0 0 0 255 188 0\nv 0 0 2 nan 1 2\nv 2 0 0\nf 1 2 3\n");
    write(folder / "ply/text", squarePlyText());
    write(folder / "ply/binary", squarePly());
    write(
        folder / "ply/rich",
        "ply\nformat ascii 1.0\ncomment c\nelement vertex 3\nproperty double x\nproperty double y\n"
        "property double z\nproperty float nx\nproperty float ny\nproperty float nz\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
        "property list uchar uint vertex_index\nelement other 1\nproperty list uchar short a\n"
        "end_header\n0 0 0 0 0 1 255 0 0\n1 0 0 0 0 1 0 255 0\n0 1 0 0 0 1 0 0 255\n3 0 1 2\n2 1 "
        "2\n");
    write(folder / "ply/colors",
          "\xef\xbb\xbfply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
          "property float y\nproperty float z\nproperty int red\nproperty int green\n"
          "property int blue\nelement face 1\nproperty list uchar int vertex_indices\n"
          "end_header\n0 0 0 255 188 0\n0 0\n2 256 -1 0\n2 0 0 nan 1 0\n3 0 1 2\n\n");
    write(folder / "ply/strips",
          "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
          "property float z\nproperty uchar diffuse_red\nproperty uchar diffuse_green\n"
          "property uchar diffuse_blue\nelement tristrips 1\n"
          "property list int int vertex_indices\nend_header\n"
          "0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n0 1 0 1 2 3\n7 0 1 3 2 -1 0 1\n");
    write(folder / "ply/face_colors",
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
          "property float z\nelement face 2\nproperty list uchar int vertex_indices\n"
          "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
          "0 0 0\n1 0 0\n1 1 0\n3 0 1 2 255 0 0\n3 0 2 1 0 0 255\n");
    write(folder / "stl/text", squareStlText());
    write(folder / "stl/upper",
          " SOLID x\n FACET NORMAL 0 1 0\n OUTER LOOP\n VERTEX 0 0 0\n VERTEX 0 0 2\n"
          " VERTEX 2 0 0\n END LOOP\n ENDFACET\nend solid x\nsolid y\n");
    write(folder / "stl/longer", squareStl() + "more");
    write(folder / "stl/binary", squareStl());
    write(folder / "off/square", squareOff());
    write(folder / "off/rich",
          "NCOFF\n3 1 0\n0 0 0 0 0 1 255 0 0 255\n1 0 0 0 0 1 0 255 0 255\n"
          "0 1 0 0 0 1 0 0 255 255\n3 0 1 2 255 0 0\n");
    write(folder / "off/glued", "OFF3 1 0\n0 0 0 0 0 2 2 0 0 3 0\n1 2");
    write(folder / "off/mixed",
          "\xef\xbb\xbfSTCOFF\n3 1\n0 0 0 1 0 0 1 0 0\n0 0 2 1 0.5 0 1 0 1\n2 0\n0 0 0 1\n3 0 1 2 "
          "9\n");
    write(folder / "om/one", squareOm());
    write(folder / "om/two", squareAndTriangleOm2());
}

std::string picture() {
    const test::TemporaryFolder folder;
    writePng(folder.path() / "a.png", {3, 2, std::vector<Rgb>(6, Rgb(0.5f))}, 0);
    return test::readBytes(folder.path() / "a.png");
}

/// A set with a texture, instances, cameras and an animation.
test::GltfBuilder richGltf() {
    test::GltfBuilder file = test::squareGltf();
    const int view = file.view(picture());
    file.append("images", {{"bufferView", view}, {"mimeType", "image/png"}});
    file.append("samplers", {{"wrapS", 33071}, {"magFilter", 9728}});
    file.append("textures", {{"source", 0}, {"sampler", 0}});
    file.append("materials", {{"alphaMode", "MASK"},
                              {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    auto& primitive = file.json["meshes"][0]["primitives"][0];
    primitive["material"] = 0;
    primitive["attributes"]["TEXCOORD_0"] =
        file.accessor<std::uint8_t>({0, 0, 255, 0, 255, 255, 0, 255}, "VEC2", 2);
    file.json["accessors"].back()["normalized"] = true;
    primitive["attributes"]["NORMAL"] = file.vectors({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
    file.append("cameras",
                {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}});
    const int child = file.append("nodes", {{"camera", 0}});
    file.root({{"mesh", 0}, {"children", {child}}});
    const int moved = file.root({{"mesh", 0}, {"translation", {2, 0, 0}}});
    file.animate(moved, "translation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0});
    return file;
}

void writeGltf(const fs::path& folder) {
    const test::GltfBuilder rich = richGltf();
    write(folder / "glb/rich", rich.glb());
    test::SkinnedBar bar = test::skinnedBar();
    bar.file.animate(bar.upper, "scale", "LINEAR", {0, 1}, {1, 1, 1, 1, 2, 1});
    write(folder / "glb/skin", bar.file.glb());
    test::GltfBuilder morphed = test::morphedSquare();
    morphed.root(test::instancesAt(morphed, {0, 0, 0, 2, 0, 0}));
    const int morphing = morphed.root({{"mesh", 0}, {"weights", {0.5, 1}}});
    morphed.animate(morphing, "weights", "LINEAR", {0, 1}, {0, 0, 1, 1});
    write(folder / "glb/morph", morphed.glb());
    write(folder / "gltf/morph", morphed.gltf("in.gltf"));
    test::GltfBuilder square = test::squareGltf();
    square.root({{"mesh", 0}});
    write(folder / "glb/square", square.glb());
    write(folder / "gltf/plain",
          R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)"
          R"("nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
          R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],)"
          R"("bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,)"
          R"("uri":"data:application/octet-stream;base64,)"
          R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
    write(folder / "gltf/beside", rich.gltf("in.gltf"));
    write(folder / "gltf/sparse",
          R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,)"
          R"("matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}],"meshes":[{"primitives":)"
          R"([{"attributes":{"POSITION":0},"mode":5}]}],"accessors":[{"componentType":5126,)"
          R"("count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":0,)"
          R"("componentType":5121},"values":{"bufferView":0}}}],"bufferViews":)"
          R"([{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"in.gltf"}]})");
    write(folder / "texture/a.png", picture());
}

void writePictures(const fs::path& folder) {
    const std::vector<float> values(24, 0.75f);
    for (const PixelType type : {PixelType::half, PixelType::full}) {
        const std::string name = type == PixelType::half ? "half" : "full";
        const test::TemporaryFolder work;
        writeExr(work.path() / "a.exr", 6, 4, {{"R", values}, {"G", values}, {"B", values}},
                 {{"shadowcache:version", "1"}}, type);
        for (const std::string kind : {"exr/", "reference/"})
            write(folder / (kind + name), test::readBytes(work.path() / "a.exr"));
    }
    const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n";
    write(folder / "hdr/flat", head + "-Y 2 +X 2\n" + std::string(16, '\x81'));
    std::string row("\2\2\0\x08", 4);
    for (int channel = 0; channel < 4; ++channel) row += "\x88\x81";
    write(folder / "hdr/coded", head + "-Y 2 +X 8\n" + row + row);
    write(folder / "hdr/runs",
          "#?X\r\nCOLORCORR=1 2 .5\r\nFORMAT= 32-bit_rle_rgbe\r\n\r\n+X 2 +Y 9\r\n" +
              std::string("\x80\x40\x20\x81\1\1\1\7\2\2\x80\x81", 12) +
              std::string("\2\2\x80\x81\1\1\1\0\1\1\1\0\x80\0\0\x81\1\1\1\7", 20));
}

void writeTexts(const fs::path& folder) {
    write(folder / "camera/one",
          R"({"version":1,"cam":{"yfov":0.9,"fps":12,"frames":[{"origin":[0.5,1e3,2],)"
          R"("forward":[0,-0.5,-1],"up":[0,1,0]}]}})");
    write(folder / "track/one", R"({"frames":[{"translation":[1,0,0],"rotation":[0,0,0,1],)"
                                R"("scale":[1,2,1e2]},{}]})");
    write(folder / "words/bake",
          "set.obj\n-o\nset.vdb\n--spacing=0.5\n--level\n3\n--shard\n2/8\n--camera\na.json\n"
          "--size\n64x48\n--dynamic\na.ply@b.json\n--seed\n7\n--up\nz\n--threads=2\n--estimate\n");
    write(folder / "words/other", "--help");
    write(folder / "words/man", "--man-page");
    write(folder / "words/completion", "--bash-completion");
    write(folder / "render_words/still",
          "set.ply\n--env\n1,0.5,2e-1\n--eye\n1,2,3\n--look-at\n0,0,0\n--size\n64x36\n--crop\n1,2,"
          "8x4\n"
          "--material\nroughness=0.3,metallic=1\n--estimator\nlights\n-o\na.exr\n--png");
    write(folder / "render_words/shot",
          "set.glb\n--env\nsky.####.exr\n--env-rotate\n10-90\n--camera\nshot\n--frames\n1-9x2,12\n-"
          "-cache\n"
          "set.vdb\n--memory\n4.5G\n--spp\n64\n--aov\ndepth\nitems\n-o\na.%04d.exr\n--resume");
    write(folder / "render_settings/toml",
          "env='sky.exr'\nframes='1-9'\nsize='8x6'\nsamples=4\naov=['depth','items']\nmaterial='"
          "ior=1.5'\n");
    write(folder / "settings/toml",
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
            write(folder / ("cache_" + kind) / ("level" + std::to_string(level)),
                  test::readBytes(work.path() / "a.vdb"));
    }
}

/// The files of other writers, each for the fuzzer of its extension.
void writeCases(const fs::path& folder) {
    for (const auto& entry : fs::directory_iterator(SHADOWCACHE_CASES))
        if (const std::string extension = entry.path().extension().string(); extension.size() > 1)
            write(folder / extension.substr(1) / entry.path().filename(),
                  test::readBytes(entry.path()));
}

void writeShotLookups(const fs::path& folder) {
    const test::TemporaryFolder work;
    ShotLookups lookups{0.5, {8, 9, 10}, {}};
    lookups.places.add({{1, 2}, {1, 700}, {std::uint64_t{1} << 40, 3}});
    writeLookups(work.path() / "a.lookups", {{"version", "1"}}, lookups);
    // The fuzzer adds the checksum.
    std::string bytes = test::readBytes(work.path() / "a.lookups");
    bytes.resize(bytes.size() - sizeof(std::uint64_t));
    write(folder / "lookups/three", bytes);
}

}  // namespace
}  // namespace shadowcache

int main(int argc, char** argv) try {
    using namespace shadowcache;
    if (argc != 2) throw Error("expected the folder to write");
    writeMeshes(argv[1]);
    writeGltf(argv[1]);
    writePictures(argv[1]);
    writeTexts(argv[1]);
    writeCaches(argv[1]);
    writeShotLookups(argv[1]);
    writeCases(argv[1]);
} catch (const std::exception& e) {
    return shadowcache::reportFailure("fuzz_seeds", e);
}
