// What scenes/blender_export writes of small scenes, in both of its forms, against what Blender
// renders of them. Skipped where Blender is not installed.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>

#include "common/import/load_mesh.h"
#include "common/import/mesh_options.h"
#include "common/mesh/placed_mesh.h"
#include "common/shot/gltf_shot.h"
#include "tests/support/needs.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

/// blender_cases.py, run once for all tests of a process.
class BlenderExport : public testing::Test {
protected:
    static void SetUpTestSuite() {
        exported = std::make_unique<TemporaryFolder>();
        const std::string command =
            "cd " + exported->path().string() +
            " && PYTHONDONTWRITEBYTECODE=1 blender -b --factory-startup --python-exit-code 1 -P " +
            SHADOWCACHE_TEST_PROGRAMS "/blender_cases.py -- " SHADOWCACHE_SCENES " > log 2>&1";
        if (std::system("command -v blender > /dev/null 2>&1") == 0)
            exportFailed = std::system(command.c_str()) != 0;
    }
    static void TearDownTestSuite() { exported.reset(); }

    void SetUp() override {
        SHADOWCACHE_NEEDS("Blender (Debian package: blender)", "command -v blender");
        ASSERT_FALSE(exportFailed) << readBytes(exported->path() / "log");
    }

    static TriangleMesh mesh(const std::string& name) {
        const std::filesystem::path path = exported->path() / name;
        MeshOptions options;
        options.zUp = name.ends_with(".ply");
        options.shadingNormals = options.gloss = true;
        return loadMesh({&path, 1}, options);
    }

    static std::string leftOut(const std::string& mode) {
        return readBytes(exported->path() / (mode + ".txt"));
    }

    /// Of the corners in the world.
    static Box3d bounds(const TriangleMesh& m) {
        Box3d box;
        for (std::uint32_t i = 0; i < placedCount(m); ++i)
            for (const Vec3d& corner : placedCorners(m, i)) box.extendBy(corner + m.origin);
        return box;
    }

    /// Both forms hold so many triangles up to this height, in the same box.
    static void expectHolds(const std::string& mode, std::size_t triangles, double height) {
        SCOPED_TRACE(mode);
        const TriangleMesh whole = mesh(mode + ".glb"), bare = mesh(mode + ".ply");
        EXPECT_EQ(placedCount(whole), triangles);
        EXPECT_EQ(placedCount(bare), triangles);
        EXPECT_NEAR(bounds(whole).max.y, height, 1e-5);
        EXPECT_LT((bounds(whole).min - bounds(bare).min).length(), 1e-5);
        EXPECT_LT((bounds(whole).max - bounds(bare).max).length(), 1e-5);
    }

    static GltfShot shot(const std::string& mode) {
        return {exported->path() / (mode + ".glb"), {}, 24};
    }

    static inline std::unique_ptr<TemporaryFolder> exported;
    static inline bool exportFailed = false;
};

// A plane of 2 triangles at height 0, a cube of 12 up to 1.
TEST_F(BlenderExport, HoldsWhatARenderShows) {
    expectHolds("shapekey", 14, 2);
    expectHolds("geonodes", 2 + 32 * 12, 1.5);
    expectHolds("subsurf", 2 + 2 * 384, 0.9197531343);
    expectHolds("modifier_off", 14, 1);
    expectHolds("eyehidden", 14, 1);
    expectHolds("screen_hidden", 14, 1);
    expectHolds("render_hidden", 2, 0);
    expectHolds("excluded", 2, 0);
    expectHolds("collection_hidden", 2, 0);
    expectHolds("ngon", 14 + 5, 2);
    expectHolds("no_camera", 14, 1);
}

// A text is a prism of 12 triangles; a ring's section has 8 sides, its circle 4 times 2 or 3 more.
TEST_F(BlenderExport, HoldsCurvesTextsAndMetaballs) {
    expectHolds("text", 14 + 12, 1);
    expectHolds("curve", 14 + 192, 1);
    EXPECT_GT(placedCount(mesh("meta.glb")), 1000u);
    EXPECT_EQ(placedCount(mesh("meta.glb")), placedCount(mesh("meta.ply")));
}

TEST_F(BlenderExport, InstancesAreStoredOnce) {
    const TriangleMesh scattered = mesh("geonodes.glb");
    EXPECT_EQ(scattered.triangles.size(), 14u);
    EXPECT_EQ(scattered.report.instances, 32u);
    // One is mirrored; one is three times as high, of a cube that leans by half a radian.
    expectHolds("collection_instances", 2 + 3 * 12,
                3 * (0.5 + 0.5 * (std::cos(0.5) + std::sin(0.5))));
    EXPECT_EQ(mesh("collection_instances.glb").triangles.size(), 14u);
}

// All faces of a convex body look away from its middle, mirrored or not.
TEST_F(BlenderExport, MirroredFacesLookOutwards) {
    for (const char* name : {"negative.glb", "negative.ply"}) {
        SCOPED_TRACE(name);
        const TriangleMesh m = mesh(name);
        for (std::uint32_t i = 0; i < placedCount(m); ++i) {
            const auto corners = placedCorners(m, i);
            const Vec3d middle = (corners[0] + corners[1] + corners[2]) / 3.0 + m.origin;
            if (std::abs(middle.x) > 1 || std::abs(middle.z) > 1 || middle.y <= 0) continue;
            const Vec3d out = middle - Vec3d(0, 0.5, 0);
            const bool mirrored = placedTriangle(m, i).instance != nullptr &&
                                  placedTriangle(m, i).instance->toWorld.mirrors();
            EXPECT_GT(out.dot(Vec3d(placedNormal(m, i))) * (mirrored ? -1 : 1), 0);
        }
    }
}

TEST_F(BlenderExport, KeepsNormals) {
    EXPECT_TRUE(mesh("eyehidden.glb").normals.empty());  // flat
    for (const Vec3f& n : mesh("smooth.glb").normals)
        EXPECT_NEAR(std::abs(n.x), std::sqrt(1 / 3.0), 1e-4);
    ASSERT_FALSE(mesh("auto_smooth.glb").normals.empty());
    for (const Vec3f& n : mesh("auto_smooth.glb").normals)
        EXPECT_NEAR(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 1, 1e-3);
    ASSERT_FALSE(mesh("custom_normals.glb").normals.empty());
    for (const Vec3f& n : mesh("custom_normals.glb").normals) EXPECT_NEAR(n.y, 1, 1e-3);
}

// Colours that a material does not use are not part of its look.
TEST_F(BlenderExport, KeepsColoursAsLinear) {
    std::size_t grey = 0, white = 0;
    for (const Rgb& c : mesh("colours.glb").colors)
        ++(std::abs(c.x - 0.214f) < 0.002f ? grey : white);
    EXPECT_EQ(grey, 8u);
    EXPECT_EQ(white, 4u);
}

TEST_F(BlenderExport, KeepsTexturesAndNamesWhatItCannotExpress) {
    const TriangleMesh m = mesh("textured.glb");
    ASSERT_EQ(m.textures.size(), 1u);
    const auto found = std::ranges::find_if(
        m.materials, [](const Material& material) { return material.texture >= 0; });
    ASSERT_NE(found, m.materials.end());
    const Material& material = *found;
    EXPECT_TRUE(material.blends);  // as in Cycles, whatever the blend mode is
    EXPECT_EQ(material.finish.emission, Rgb(4, 2, 0));
    // Blender's first row is the lowest, t points downwards.
    EXPECT_EQ(textureColor(m.textures[0], 0.25f, 0.75f), Rgb(1, 0, 0));
    EXPECT_NEAR(textureOpacity(m.textures[0], 0.75f, 0.75f), 0.5, 0.01);
    EXPECT_EQ(leftOut("textured"),
              "material check: Roughness: node Noise Texture\n"
              "Principled BSDF: its lobes are those of glTF; where they are rough, light differs "
              "from Cycles by up to a tenth (check)\nmaterial check: Clearcoat\n"
              "Transparent Max Bounces: Cycles ends light behind 8 transparent surfaces, here it "
              "goes on (check)\n");
    EXPECT_EQ(leftOut("lamp"), "object Cube: hidden from the camera\n");
    EXPECT_EQ(leftOut("deforming"), "object Cube: its vertices move; it is as in frame 1\n");
    EXPECT_EQ(leftOut("eyehidden"), "");
}

TEST_F(BlenderExport, KeepsWhatMoves) {
    const GltfShot gone = shot("vanishing"), turned = shot("moving");
    ASSERT_EQ(gone.movingNodes().size(), 1u);
    EXPECT_NEAR(gone.place(gone.movingNodes()[0], 1).determinant(), 1, 1e-6);
    EXPECT_NEAR(gone.place(gone.movingNodes()[0], 3).determinant(), 0, 1e-6);
    ASSERT_EQ(turned.movingNodes().size(), 1u);
    for (const int frame : {1, 3}) {
        const Affine place = turned.place(turned.movingNodes()[0], frame);
        const double c = std::cos(0.4 * frame), s = std::sin(0.4 * frame);
        // Blender's x, turned about its z and then twice as long in its y: that is -z here.
        EXPECT_LT((place.axis[0] - Vec3d(c, 0, -2 * s)).length(), 1e-5);
        EXPECT_LT((place.axis[2] - Vec3d(s, 0, 2 * c)).length(), 1e-5);
    }
    EXPECT_TRUE(shot("no_camera").cameraNodes().empty());
    EXPECT_EQ(shot("eyehidden").cameraNodes().size(), 1u);
}

}  // namespace
}  // namespace shadowcache::test
