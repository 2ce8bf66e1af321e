// The courtyard is the same set in both of its files; the glTF has its finishes.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "common/import/load_mesh.h"
#include "common/mesh/looks.h"
#include "scenes/sets.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

using Corners = std::array<float, 9>;

struct BundledSet : testing::Test {
    TemporaryFolder folder;
    scenes::SetMesh set = scenes::makeCourtyard();

    TriangleMesh load(const char* name,
                      void (*write)(const std::filesystem::path&, const scenes::SetMesh&)) {
        const std::filesystem::path path = folder.path() / name;
        write(path, set);
        MeshOptions options;
        options.gloss = options.shadingNormals = true;
        return loadMesh({&path, 1}, options);
    }
    TriangleMesh gltf() { return load("set.glb", scenes::writeGlb); }
};

/// The triangles by their corners, sorted: the files have them in different orders.
std::vector<Corners> cornersOf(const TriangleMesh& mesh) {
    std::vector<Corners> all;
    for (const Vec3i& t : mesh.triangles) {
        std::array<Vec3d, 3> p;
        for (std::size_t k = 0; k < 3; ++k)
            p[k] = mesh.origin +
                   Vec3d(mesh.positions[static_cast<std::size_t>(t[static_cast<int>(k)])]);
        Corners corners;
        for (std::size_t i = 0; i < 9; ++i)
            corners[i] = static_cast<float>(p[i / 3][static_cast<int>(i % 3)]);
        all.push_back(corners);
    }
    std::sort(all.begin(), all.end());
    return all;
}

TEST_F(BundledSet, BothFilesHoldTheSameTriangles) {
    const auto ply = cornersOf(load("set.ply", scenes::writePly));
    const auto glb = cornersOf(gltf());
    ASSERT_EQ(ply.size(), glb.size());
    for (std::size_t i = 0; i < ply.size(); ++i)
        for (std::size_t k = 0; k < 9; ++k) ASSERT_NEAR(ply[i][k], glb[i][k], 1e-5);
}

TEST_F(BundledSet, GltfHasEveryFinishOfTheSet) {
    const TriangleMesh mesh = gltf();
    EXPECT_TRUE(mesh.report.leftOut.empty()) << describe(mesh.report);
    std::vector<int> finishes;
    for (const scenes::Finish f : set.finishes) finishes.push_back(static_cast<int>(f));
    std::sort(finishes.begin(), finishes.end());
    finishes.erase(std::unique(finishes.begin(), finishes.end()), finishes.end());
    EXPECT_EQ(mesh.parts.size(), finishes.size());
    std::size_t matte = 0, glossy = 0;
    for (const MeshPart& part : mesh.parts) {
        const Surface surface = surfaceAt(mesh, part.firstTriangle, 0.3f, 0.3f, {});
        (surface.glossy ? glossy : matte) += part.triangleCount;
    }
    const auto isMatte = [](scenes::Finish f) { return f == scenes::Finish::matte; };
    EXPECT_EQ(matte, static_cast<std::size_t>(
                         std::count_if(set.finishes.begin(), set.finishes.end(), isMatte)));
    EXPECT_GT(glossy, 10'000u);
}

TEST_F(BundledSet, NormalsAreSmoothAndFaceTheWayOfTheTriangle) {
    const TriangleMesh mesh = gltf();
    ASSERT_EQ(mesh.cornerNormals.size(), mesh.triangles.size());
    EXPECT_EQ(mesh.report.badNormals, 0u);
    std::size_t bent = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto p = [&](int k) {
            return mesh.positions[static_cast<std::size_t>(mesh.triangles[i][k])];
        };
        const Vec3f flat = (p(1) - p(0)).cross(p(2) - p(0)).normalized();
        for (int k = 0; k < 3; ++k) {
            const int normal = mesh.cornerNormals[i][k];
            if (normal < 0) continue;
            const float cosine = flat.dot(mesh.normals[static_cast<std::size_t>(normal)]);
            ASSERT_GT(cosine, 0.5f) << "triangle " << i;
            bent += cosine < 0.999f;
        }
    }
    EXPECT_GT(bent, 10'000u);
}

}  // namespace
}  // namespace shadowcache::test
