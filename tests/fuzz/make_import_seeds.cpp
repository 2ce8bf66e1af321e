// Sets in every format, their materials and what is compressed in them.

#include "common/image/png.h"
#include "tests/fuzz/make_seeds.h"
#include "tests/support/compressed_gltf.h"
#include "tests/support/gltf_posed.h"
#include "tests/support/mesh_files.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache {
namespace {

namespace fs = std::filesystem;

void writeMeshes(const fs::path& folder) {
    using namespace test;
    writeSeed(folder / "obj/square", squareObj());
    writeSeed(folder / "obj/rich",
              "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 1 1 1\nvn 0 0 1\nvt 0 0\n"
              "f -4//1 -3//1 \\\n-2//1\nf 1/1/1 3/1/1 4/1/1\nf 1 2 3 4\ng a\ns 1\nusemtl b\n");
    writeSeed(folder / "obj/colors",
              "\xef\xbb\xbfv 0 0 0 255 188 0\nv 0 0 2 nan 1 2\nv 2 0 0\nf 1 2 3\n");
    writeSeed(
        folder / "obj/statements",
        "v 0 0 0\rv 1 0 0\rv 1 1 0\rfo 1 2 3\rl 1 2\rp 1\rsurf 0 1 0 1 1 2\rend\rcall a.obj\r");
    writeSeed(folder / "ply/text", squarePlyText());
    writeSeed(folder / "ply/binary", squarePly());
    writeSeed(
        folder / "ply/rich",
        "ply\nformat ascii 1.0\ncomment c\nelement vertex 3\nproperty double x\nproperty double y\n"
        "property double z\nproperty float nx\nproperty float ny\nproperty float nz\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
        "property list uchar uint vertex_index\nelement other 1\nproperty list uchar short a\n"
        "end_header\n0 0 0 0 0 1 255 0 0\n1 0 0 0 0 1 0 255 0\n0 1 0 0 0 1 0 0 255\n3 0 1 2\n2 1 "
        "2\n");
    writeSeed(folder / "ply/colors",
              "\xef\xbb\xbfply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
              "property float y\nproperty float z\nproperty int red\nproperty int green\n"
              "property int blue\nelement face 1\nproperty list uchar int vertex_indices\n"
              "end_header\n0 0 0 255 188 0\n0 0\n2 256 -1 0\n2 0 0 nan 1 0\n3 0 1 2\n\n");
    writeSeed(folder / "ply/strips",
              "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
              "property float z\nproperty uchar diffuse_red\nproperty uchar diffuse_green\n"
              "property uchar diffuse_blue\nelement tristrips 1\n"
              "property list int int vertex_indices\nend_header\n"
              "0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n0 1 0 1 2 3\n7 0 1 3 2 -1 0 1\n");
    writeSeed(folder / "ply/face_colors",
              "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
              "property float z\nelement face 2\nproperty list uchar int vertex_indices\n"
              "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
              "0 0 0\n1 0 0\n1 1 0\n3 0 1 2 255 0 0\n3 0 2 1 0 0 255\n");
    writeSeed(folder / "stl/text", squareStlText());
    writeSeed(folder / "stl/upper",
              " SOLID x\n FACET NORMAL 0 1 0\n OUTER LOOP\n VERTEX 0 0 0\n VERTEX 0 0 2\n"
              " VERTEX 2 0 0\n END LOOP\n ENDFACET\nend solid x\nsolid y\n");
    writeSeed(folder / "stl/longer", squareStl() + "more");
    writeSeed(folder / "stl/binary", squareStl());
    writeSeed(folder / "off/square", squareOff());
    writeSeed(folder / "off/rich",
              "NCOFF\n3 1 0\n0 0 0 0 0 1 255 0 0 255\n1 0 0 0 0 1 0 255 0 255\n"
              "0 1 0 0 0 1 0 0 255 255\n3 0 1 2 255 0 0\n");
    writeSeed(folder / "off/glued", "OFF3 1 0\n0 0 0 0 0 2 2 0 0 3 0\n1 2");
    writeSeed(
        folder / "off/mixed",
        "\xef\xbb\xbfSTCOFF\n3 1\n0 0 0 1 0 0 1 0 0\n0 0 2 1 0.5 0 1 0 1\n2 0\n0 0 0 1\n3 0 1 2 "
        "9\n");
    writeSeed(
        folder / "off/faces",
        "OFF\n4 3 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 255 0 0\n3 0 2 3 0 .5 nan 1\n3 1 2 3 7\n");
    std::string marked = squareStl();
    marked[84 + 49] = '\x80';
    writeSeed(folder / "stl/colors", marked);
    writeSeed(folder / "om/one", squareOm());
    writeSeed(folder / "om/two", squareAndTriangleOm2());
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
    writeSeed(folder / "glb/rich", rich.glb());
    test::SkinnedBar bar = test::skinnedBar();
    bar.file.animate(bar.upper, "scale", "LINEAR", {0, 1}, {1, 1, 1, 1, 2, 1});
    writeSeed(folder / "glb/skin", bar.file.glb());
    test::GltfBuilder morphed = test::morphedSquare();
    morphed.root(test::instancesAt(morphed, {0, 0, 0, 2, 0, 0}));
    const int morphing = morphed.root({{"mesh", 0}, {"weights", {0.5, 1}}});
    morphed.animate(morphing, "weights", "LINEAR", {0, 1}, {0, 0, 1, 1});
    writeSeed(folder / "glb/morph", morphed.glb());
    writeSeed(folder / "gltf/morph", morphed.gltf("in.gltf"));
    test::GltfBuilder square = test::squareGltf();
    square.root({{"mesh", 0}});
    writeSeed(folder / "glb/square", square.glb());
    writeSeed(folder / "gltf/plain",
              R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)"
              R"("nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
              R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],)"
              R"("bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,)"
              R"("uri":"data:application/octet-stream;base64,)"
              R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
    writeSeed(folder / "gltf/beside", rich.gltf("in.gltf"));
    writeSeed(folder / "gltf/sparse",
              R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,)"
              R"("matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}],"meshes":[{"primitives":)"
              R"([{"attributes":{"POSITION":0},"mode":5}]}],"accessors":[{"componentType":5126,)"
              R"("count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":0,)"
              R"("componentType":5121},"values":{"bufferView":0}}}],"bufferViews":)"
              R"([{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"in.gltf"}]})");
    writeSeed(folder / "texture/a.png", picture());
}

void writeMaterials(const fs::path& folder) {
    writeSeed(folder / "mtl/plain",
              "newmtl a\nKd .5 .25 1\nKs 1 1 1\nNs 250\nd .5\nillum 2\nnewmtl b\nKe 2 3 4\n"
              "Pr .5\nPm 1\nTr .2\nNi 1.5\n");
    writeSeed(folder / "mtl/maps",
              "newmtl a\nmap_Kd -s 2 2 1 -o .5 0 0 -mm 0 1 -clamp on a.png\nmap_d a.png\n"
              "map_Bump -bm .5 a.png\nnorm -bm 2 a.png\nnewmtl b\nmap_Pr a.png\n"
              "map_Pm -imfchan l a.png\nKe 1 1 1\nmap_Ke \"a.png\"\n");
    writeSeed(folder / "mtl/left_out",
              "\xef\xbb\xbf# c\nnewmtl a\nKd spectral a.rfl\nTf xyz .5 .5 .5\nd -halo .5\n"
              "illum 7\nrefl -type sphere a.png\nKd 255 -1 nan\nnewmtl a\nfoo \\\n1\n");
}

void writeCompressed(const fs::path& folder) {
    using namespace test;
    for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
        const std::string name = std::to_string(method);
        writeSeed(folder / "draco" / name, dracoSquare(method));
        writeSeed(folder / "glb" / ("draco" + name), dracoFile(dracoSquare(method)).glb());
    }
    writeSeed(folder / "meshopt/attributes", std::string("\0\0\x0b\4\0", 5) + meshoptPositions());
    writeSeed(folder / "meshopt/triangles", std::string("\1\0\1\6\0", 5) + meshoptTriangles());
    writeSeed(folder / "meshopt/filtered", std::string("\0\3\x0b\4\0", 5) + meshoptPositions());
    std::string data;
    nlohmann::json json = meshoptFile(meshoptPositions(), meshoptTriangles(), data);
    json["buffers"][0]["uri"] = "in.gltf";
    writeSeed(folder / "gltf/meshopt", json.dump());
    for (const bool lossless : {true, false})
        writeSeed(folder / "webp" / (lossless ? "lossless" : "lossy"), webpPicture(lossless));
}

}  // namespace

void writeImportSeeds(const fs::path& folder) {
    writeMeshes(folder);
    writeGltf(folder);
    writeMaterials(folder);
    writeCompressed(folder);
}

}  // namespace shadowcache
