// Libraries of materials of OBJ files, with a picture that they may name: "a.png".

#include "common/image/png.h"
#include "common/import/load_mesh.h"
#include "common/import/set_files.h"
#include "tests/fuzz/input_file.h"

namespace {

/// Beside the library; its name begins with the library's, as those that refusals name do.
std::filesystem::path writeSet(const std::filesystem::path& library) {
    std::filesystem::path set = library;
    set += ".obj";
    std::ofstream(set) << "mtllib " << library.filename().string()
                       << "\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n"
                          "usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 3/3 4\n";
    shadowcache::writePng(set.parent_path() / "a.png",
                          {2, 1, {shadowcache::Rgb(0.5f), shadowcache::Rgb(1.0f)}}, 0);
    return set;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace shadowcache;
    static fuzz::InputFile file("in.mtl");
    static const std::filesystem::path set = writeSet(file.write({bytes, size}));
    fuzz::readAs(file, {bytes, size}, [](const std::filesystem::path&) {
        MeshOptions options;
        options.gloss = options.shadingNormals = true;
        filesOf(set, References::inside);
        const TriangleMesh mesh = loadMesh({&set, 1}, options);
        fuzz::require(mesh.triangles.size() == 2);
        for (const Material& m : mesh.materials) {
            fuzz::require(m.opacity >= 0 && m.opacity <= 1 && std::isfinite(m.normalScale));
            for (int k = 0; k < 3; ++k)
                fuzz::require(m.albedo[k] >= 0 && m.albedo[k] <= 1 &&
                              std::isfinite(m.finish.emission[k]));
        }
    });
    return 0;
}
