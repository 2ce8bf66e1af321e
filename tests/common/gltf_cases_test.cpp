// Small glTF files that other programs read wrongly, with the right values.

#include <gtest/gtest.h>

#include "common/import/load_mesh.h"
#include "common/mesh/looks.h"
#include "common/mesh/mesh_fingerprint.h"
#include "common/mesh/placed_mesh.h"

namespace shadowcache {
namespace {

TriangleMesh load(const std::string& name) {
    const std::filesystem::path path = std::filesystem::path(SHADOWCACHE_CASES) / name;
    return loadMesh({&path, 1}, {.gloss = true});
}

/// Heights of a set's triangles in the world.
std::pair<double, double> heights(const TriangleMesh& mesh) {
    const Box3d box = placedBounds(mesh);
    return {mesh.origin.y + box.min.y, mesh.origin.y + box.max.y};
}

TEST(GltfCases, InstancesOfAnExtensionThatIsOptional) {
    EXPECT_EQ(placedCount(load("inst.gltf")), 6u);
}

TEST(GltfCases, WeightsOfANodeReplaceTheMeshs) {
    EXPECT_EQ(heights(load("morph_nodeweights.gltf")), std::pair(1.0, 1.0));
    EXPECT_EQ(heights(load("morph_node0.gltf")), std::pair(0.0, 0.0));
}

TEST(GltfCases, DiffuseColourOfSpecularGlossiness) {
    const TriangleMesh mesh = load("specgloss_req.gltf");
    EXPECT_EQ(albedoAt(mesh, 0, 0.25f, 0.25f, Rgb(0.5f)), Rgb(1, 0, 0));
}

TEST(GltfCases, AllRootsOfAFileWithoutScenes) {
    EXPECT_EQ(load("no_scenes.gltf").triangles.size(), 2u);
}

TEST(GltfCases, ACacheKnowsWhichSidesAreSeen) {
    EXPECT_NE(fingerprint(load("b_ss.gltf")), fingerprint(load("b_ds.gltf")));
    EXPECT_EQ(fingerprint(load("b_ds.gltf")), fingerprint(load("b_ds.gltf")));
}

}  // namespace
}  // namespace shadowcache
