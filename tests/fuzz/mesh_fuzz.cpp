// OBJ, PLY, STL, OFF and OM files, to the mesh that they make.

#include "common/import/load_mesh.h"
#include "common/math/limits.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace shadowcache;
    static fuzz::InputFile file(std::string("in") + SHADOWCACHE_EXTENSION);
    fuzz::readAs(file, {bytes, size}, [](const std::filesystem::path& path) {
        MeshOptions options;
        options.shadingNormals = true;
        options.smoothDegrees = 30;
        const TriangleMesh mesh = loadMesh(std::span(&path, 1), options);
        fuzz::require(!mesh.triangles.empty());
        for (const Vec3f& p : mesh.positions) fuzz::require(isInReach(Vec3d(p) / 2));
        for (const Rgb& c : mesh.colors)
            for (int k = 0; k < 3; ++k) fuzz::require(c[k] >= 0 && c[k] <= 1);
        for (const Vec3i& t : mesh.triangles)
            for (int k = 0; k < 3; ++k)
                fuzz::require(t[k] >= 0 && static_cast<std::size_t>(t[k]) < mesh.positions.size());
    });
    return 0;
}
