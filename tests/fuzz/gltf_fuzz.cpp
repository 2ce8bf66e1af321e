// glTF files, as text and as GLB: the mesh, cameras, and nodes over time. A .gltf file may name
// the picture and the buffer beside it.

#include "common/import/load_mesh.h"
#include "common/import/set_files.h"
#include "common/shot/moving_lamps.h"
#include "common/shot/moving_set.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace shadowcache;
    static fuzz::InputFile file(std::string("in") + SHADOWCACHE_EXTENSION);
    const auto mayRefuse = [&](const auto& read) { fuzz::readAs(file, {bytes, size}, read); };
    mayRefuse([](const std::filesystem::path& path) {
        MeshOptions options;
        options.shadingNormals = true;
        loadMesh(std::span(&path, 1), options);
    });
    mayRefuse(
        [](const std::filesystem::path& path) { loadMesh(std::span(&path, 1), {.stillAt = 0.1}); });
    mayRefuse([](const std::filesystem::path& path) {
        filesOf(path, References::inside);
        const GltfShot shot(path, {}, 24);
        for (const int node : shot.movingNodes()) shot.place(node, 3);
        for (const int node : shot.cameraNodes()) shot.camera(node, 3);
        describe(shot);
        MovingSet moving({&shot, 1}, {}, {}, Vec3d(0.0));
        moving.pose(3);
        MovingLamps(std::span(&shot, 1), {}, {}, Vec3d(0.0)).at(3);
    });
    return 0;
}
