// Morph targets, skins and instances of glTF files: where their vertices are.

#include <gtest/gtest.h>

#include <cmath>

#include "common/import/load_mesh.h"
#include "common/mesh/placed_mesh.h"
#include "common/shot/moving_set.h"
#include "tests/support/gltf_posed.h"
#include "tests/support/loaded_mesh.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

using Json = nlohmann::json;

void expectRefused(const GltfBuilder& file, const std::string& cause) {
    const TemporaryFolder folder;
    const auto path = folder.write("a.glb", file.glb());
    expectError([&] { loadMesh({&path, 1}, {}); }, "a.glb", cause);
}

/// Vertices in the file's order, in the world; of a set without instances.
std::vector<Vec3d> vertices(const TriangleMesh& mesh) {
    std::vector<Vec3d> all;
    for (const Vec3f& p : mesh.positions) all.push_back(mesh.origin + Vec3d(p));
    return all;
}

void expectNear(const Vec3d& found, const Vec3d& wanted) {
    EXPECT_NEAR((found - wanted).length(), 0, 1e-6)
        << found.x << ' ' << found.y << ' ' << found.z << ", expected " << wanted.x << ' '
        << wanted.y << ' ' << wanted.z;
}

TEST(GltfMorph, NodesHaveWeightsOfTheirOwn) {
    GltfBuilder file = morphedSquare();
    file.json["meshes"][0]["weights"] = {0.5, 0};
    file.root({{"mesh", 0}});
    expectNear(vertices(loadGlb(file))[2], {1, 1, 0.5});
    file.json["nodes"][0]["weights"] = {0, 0};
    expectNear(vertices(loadGlb(file))[2], {1, 1, 0});
    file.json["nodes"][0]["weights"] = {-1, 0.25};
    expectNear(vertices(loadGlb(file))[2], {1.5, 1, -1});
    expectNear(vertices(loadGlb(file))[0], {0, 0, -1});
    // Fewer than targets, and more.
    file.json["nodes"][0]["weights"] = {2};
    expectNear(vertices(loadGlb(file))[2], {1, 1, 2});
    file.json["nodes"][0]["weights"] = {2, 0, 7};
    expectNear(vertices(loadGlb(file))[2], {1, 1, 2});
}

TEST(GltfMorph, MovesNormals) {
    GltfBuilder file = morphedSquare();
    file.root({{"mesh", 0}, {"weights", {1, 0}}});
    const TriangleMesh mesh = loadGlb(file, {.shadingNormals = true});
    ASSERT_FALSE(mesh.normals.empty());
    expectNear(Vec3d(mesh.normals[0]), Vec3d(1, 0, 1).normalized());
}

TEST(GltfMorph, NodesOfOneFormShareIt) {
    GltfBuilder file = morphedSquare();
    file.root({{"mesh", 0}, {"weights", {1, 0}}});
    file.root({{"mesh", 0}, {"weights", {1, 0}}, {"translation", {5, 0, 0}}});
    file.root({{"mesh", 0}, {"translation", {0, 5, 0}}});
    const TriangleMesh mesh = loadGlb(file);
    EXPECT_EQ(mesh.instances.size(), 2u);
    EXPECT_EQ(mesh.triangles.size(), 4u);
    const Box3d box = placedBounds(mesh);
    EXPECT_NEAR(box.size().x, 6, 1e-6);
    EXPECT_NEAR(box.size().z, 1, 1e-6);
}

TEST(GltfMorph, TargetsThatDoNotFitAreRefused) {
    GltfBuilder file = morphedSquare();
    file.root({{"mesh", 0}, {"weights", {1, 1}}});
    Json& target = file.json["meshes"][0]["primitives"][0]["targets"][1]["POSITION"];
    target = file.vectors({0, 0, 0});
    expectRefused(file, "morph target 1, POSITION: 3 numbers, expected 3 for each of 4 vertices");
    target = 99;
    expectRefused(file, "morph target 1: POSITION accessor 99, expected 0 to");
}

TEST(GltfSkin, JointsPlaceTheVertices) {
    SkinnedBar bar = skinnedBar();
    const auto still = vertices(loadGlb(bar.file));
    expectNear(still[0], {0, 0, 0});
    expectNear(still[4], {1, 2, 0});
    const double h = std::sqrt(0.5);
    bar.file.json["nodes"][bar.upper]["rotation"] = {0, 0, h, h};
    const auto bent = vertices(loadGlb(bar.file));
    expectNear(bent[1], {1, 0, 0});
    expectNear(bent[4], {-1, 2, 0});
    expectNear(bent[5], {-1, 1, 0});
    // Half with either joint.
    expectNear(bent[2], {0.5, 1.5, 0});
    // What moves the whole skeleton moves the mesh.
    bar.file.json["nodes"][bar.lower]["translation"] = {0, 0, 3};
    expectNear(vertices(loadGlb(bar.file))[4], {-1, 2, 3});
}

TEST(GltfSkin, TurnsNormalsAndKeepsTheFront) {
    SkinnedBar bar = skinnedBar();
    const double h = std::sqrt(0.5);
    bar.file.json["nodes"][bar.upper]["rotation"] = {h, 0, 0, h};
    const TriangleMesh bent = loadGlb(bar.file, {.shadingNormals = true});
    expectNear(Vec3d(bent.normals[4]), {0, -1, 0});
    // A mirrored skeleton: the winding is mended, so that the front stays with the normals.
    bar.file.json["nodes"][bar.upper]["rotation"] = {0, 0, 0, 1};
    bar.file.json["nodes"][bar.lower]["scale"] = {-1, 1, 1};
    const TriangleMesh mirrored = loadGlb(bar.file, {.shadingNormals = true});
    for (std::uint32_t i = 0; i < 4; ++i) EXPECT_GT(placedNormal(mirrored, i).z, 0.99f);
    for (const Vec3f& n : mirrored.normals) EXPECT_GT(n.z, 0.99f);
}

TEST(GltfSkin, WeightsAreSharesOfTheirSum) {
    SkinnedBar bar = skinnedBar();
    bar.file.json["nodes"][bar.upper]["translation"] = {0, 3, 0};
    Json& weights = bar.file.json["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"];
    const std::vector<std::uint8_t> bytes{100, 0,  0, 0, 100, 0, 0, 0, 50,  50, 0, 0,
                                          50,  50, 0, 0, 0,   0, 0, 0, 100, 0,  0, 0};
    weights = bar.file.accessor(bytes, "VEC4", 4);
    bar.file.json["accessors"].back()["normalized"] = true;
    const auto found = vertices(loadGlb(bar.file));
    expectNear(found[0], {0, 0, 0});
    expectNear(found[2], {1, 2, 0});
    expectNear(found[5], {0, 4, 0});
    // Without any weight: the first joint's.
    expectNear(found[4], {1, 2, 0});
}

TEST(GltfSkin, WhatDoesNotFitIsRefused) {
    const auto refused = [](const std::function<void(SkinnedBar&)>& change,
                            const std::string& cause) {
        SkinnedBar bar = skinnedBar();
        change(bar);
        expectRefused(bar.file, cause);
    };
    refused([](SkinnedBar& b) { b.file.json["skins"][0]["joints"] = {b.lower}; },
            "JOINTS_0: joint 1, expected 0 to 0");
    refused(
        [](SkinnedBar& b) {
            b.file.json["skins"][0]["joints"] = {b.lower, 77};
        },
        "joint 77, expected 0 to 2");
    refused([](SkinnedBar& b) { b.file.json["skins"][0]["joints"] = Json::array(); }, "no joints");
    refused(
        [](SkinnedBar& b) {
            b.file.json["accessors"][b.file.json["skins"][0]["inverseBindMatrices"].get<int>()]
                       ["count"] = 1;
        },
        "1 inverse bind matrices of 16 numbers for a skin of 2 joints");
    refused(
        [](SkinnedBar& b) {
            b.file.json["meshes"][0]["primitives"][0]["attributes"].erase("JOINTS_0");
        },
        "has a skin, expected JOINTS_0 and WEIGHTS_0 for each vertex");
    // A ring of joints has no place in the world.
    refused(
        [](SkinnedBar& b) {
            const int a = b.file.append("nodes", Json::object());
            const int c = b.file.append("nodes", {{"children", {a}}});
            b.file.json["nodes"][a]["children"] = {c};
            b.file.json["skins"][0]["joints"] = {b.lower, a};
        },
        "below themselves");
}

/// Programs write a clip of each gait into one file.
TEST(GltfAnimations, ThatGiveWayToALaterOneAreNamed) {
    GltfBuilder file = squareScene();
    const int still = file.root({{"mesh", 0}});
    const int node = file.root({{"mesh", 0}, {"translation", {5, 0, 0}}});
    for (const float x : {1.0f, 2.0f})
        file.animate(node, "translation", "LINEAR", {0, 1}, {x, 0, 0, x, 1, 0});
    file.json["animations"][0]["name"] = "walk";
    file.json["animations"][1]["name"] = "run";
    const LeftOutOf wanted{
        {{"animation", "movements give way to those of a later one, where both have some: walk"},
         1}};
    EXPECT_EQ(loadGlb(file).report.leftOutOf, wanted);
    // Of another node, or another thing of the same.
    Json& target = file.json["animations"][1]["channels"][0]["target"];
    target["path"] = "scale";
    EXPECT_TRUE(loadGlb(file).report.leftOutOf.empty());
    target = {{"node", still}, {"path", "translation"}};
    EXPECT_TRUE(loadGlb(file).report.leftOutOf.empty());
}

TEST(GltfInstancing, PlacesEachCopy) {
    GltfBuilder file = squareGltf();
    Json node = instancesAt(file, {0, 0, 0, 3, 0, 0, 0, 0, 5});
    Json& attributes = node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    // Quarter turns about z and none, as whole numbers that stand for [-1, 1].
    attributes["ROTATION"] = file.accessor(
        std::vector<std::int16_t>{0, 0, 0, 32767, 0, 0, 23170, 23170, 0, 0, 0, 32767}, "VEC4", 4);
    file.json["accessors"].back()["normalized"] = true;
    attributes["SCALE"] = file.vectors({1, 1, 1, 2, 1, 1, -1, 1, 1});
    attributes["_ID"] = file.scalars({1, 2, 3});
    node["translation"] = {0, 0, 10};
    file.root(node);
    const TriangleMesh mesh = loadGlb(file);
    ASSERT_EQ(mesh.instances.size(), 3u);
    EXPECT_EQ(placedCount(mesh), 6u);
    const auto corner = [&](std::uint32_t triangle, std::size_t k) {
        return mesh.origin + placedCorners(mesh, triangle)[k];
    };
    expectNear(corner(0, 1), {1, 0, 10});
    EXPECT_NEAR((corner(2, 1) - Vec3d(3, 2, 10)).length(), 0, 1e-4);
    expectNear(corner(4, 1), {-1, 0, 15});
    for (std::uint32_t i = 0; i < 6; ++i) EXPECT_GT(placedNormal(mesh, i).z, 0.99f);
    const LeftOutOf wanted{{{"instance", "attribute _ID is left out"}, 1}};
    EXPECT_EQ(mesh.report.leftOutOf, wanted) << describe(mesh.report);
}

TEST(GltfInstancing, WhatDoesNotFitIsRefused) {
    const auto refused = [](const std::function<void(GltfBuilder&, Json&)>& change,
                            const std::string& cause) {
        GltfBuilder file = squareGltf();
        Json node = instancesAt(file, {0, 0, 0, 3, 0, 0});
        change(file, node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]);
        file.root(node);
        expectRefused(file, cause);
    };
    refused(
        [](GltfBuilder& f, Json& a) {
            a["SCALE"] = f.vectors({1, 1, 1});
        },
        "TRANSLATION: 2 elements of 3 components, expected 1 of 3");
    refused(
        [](GltfBuilder& f, Json& a) {
            a["ROTATION"] = f.vectors({1, 1, 1, 1, 1, 1});
        },
        "EXT_mesh_gpu_instancing ROTATION: 2 elements of 3 components, expected 2 of 4");
    refused([](GltfBuilder&, Json& a) { a["TRANSLATION"] = 50; },
            "EXT_mesh_gpu_instancing: attributes: TRANSLATION accessor 50, expected 0 to");
    refused([](GltfBuilder&, Json& a) { a = Json::object(); }, "no attributes");
    refused(
        [](GltfBuilder& f, Json& a) {
            a["TRANSLATION"] = f.vectors({0, 0, std::numeric_limits<float>::infinity(), 0, 0, 0});
        },
        "instance 0 is not finite");
}

/// A joint turns in a second; the mesh is no part of the static set unless the set stands still.
class AnimatedBar : public testing::Test {
protected:
    AnimatedBar() {
        const float h = std::sqrt(0.5f);
        SkinnedBar bar = skinnedBar();
        bar.file.animate(bar.upper, "rotation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0, h, h});
        path_ = folder_.write("bar.glb", bar.file.glb());
    }

    TemporaryFolder folder_;
    std::filesystem::path path_;
};

TEST_F(AnimatedBar, StandsStillInTheFrameThatIsAskedFor) {
    expectError([&] { loadMesh({&path_, 1}, {}); }, "bar.glb", "everything moves");
    expectNear(vertices(loadMesh({&path_, 1}, {.stillAt = 0}))[4], {1, 2, 0});
    expectNear(vertices(loadMesh({&path_, 1}, {.stillAt = 1}))[4], {-1, 2, 0});
    const MeshOptions still{.stillAt = 1};
    EXPECT_TRUE(GltfShot(path_, still, 24).movingNodes().empty());
}

TEST_F(AnimatedBar, ChangesItsFormFromFrameToFrame) {
    std::vector<GltfShot> shots = openShots({&path_, 1}, {}, 10);
    ASSERT_EQ(shots[0].movingNodes().size(), 1u);
    MovingSet moving(shots, {}, {}, Vec3d(0.0));
    for (GltfShot& shot : shots) shot.dropData();
    EXPECT_EQ(moving.triangles(), 4u);
    // Its outermost corner in frames 0, 5 and 10: at (1, 1) from the joint, turned.
    for (const int frame : {0, 10, 5, 0}) {
        const Scene* scene = moving.pose(frame);
        ASSERT_NE(scene, nullptr);
        const double angle = frame * 0.1 * kPi / 2 + kPi / 4;
        const Vec3d corner(std::sqrt(2.0) * std::cos(angle), 1 + std::sqrt(2.0) * std::sin(angle),
                           0);
        const TriangleMesh& mesh = scene->mesh();
        double nearest = 1;
        for (std::uint32_t i = 0; i < placedCount(mesh); ++i)
            for (const Vec3d& p : placedCorners(mesh, i))
                nearest = std::min(nearest, (p + mesh.origin - corner).length());
        EXPECT_NEAR(nearest, 0, 1e-5) << frame;
    }
}

/// What moves may lie far from its own origin, and be of any size there.
TEST(MovingNodes, AreWhereTheirNodesBringThem) {
    GltfBuilder file;
    constexpr float kFar = 65536;
    const int positions =
        file.vectors({kFar, 0, 0, kFar + 1, 0, 0, kFar + 1, 0.125f, 0, kFar, 0.125f, 0});
    const int indices = file.accessor(kSquareIndices, "SCALAR", 1);
    file.mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
    const int node = file.root({{"mesh", 0}, {"scale", {2, 2, 2}}});
    file.animate(node, "translation", "LINEAR", {0, 1}, {-2 * kFar, 0, 0, 4 - 2 * kFar, 0, 0});
    const TemporaryFolder folder;
    const auto path = folder.write("a.glb", file.glb());
    const std::vector<GltfShot> shots = openShots({&path, 1}, {}, 4);
    MovingSet moving(shots, {}, {}, Vec3d(0.0));
    const TriangleMesh& mesh = moving.pose(2)->mesh();
    const Box3d box = placedBounds(mesh);
    expectNear(box.min, {2, 0, 0});
    expectNear(box.max, {4, 0.25, 0});
    for (const Vec3f& p : mesh.positions) EXPECT_LT(p.length(), 2);
}

TEST_F(AnimatedBar, IsInvisibleWhereItIsAPoint) {
    SkinnedBar bar = skinnedBar();
    bar.file.animate(bar.lower, "scale", "STEP", {0, 1, 2}, {1, 1, 1, 0, 0, 0, 1, 1, 1});
    path_ = folder_.write("gone.glb", bar.file.glb());
    const std::vector<GltfShot> shots = openShots({&path_, 1}, {}, 1);
    MovingSet moving(shots, {}, {}, Vec3d(0.0));
    for (const int frame : {0, 1, 2}) {
        const Hit hit = moving.pose(frame)->intersect({0.25f, 0.5f, 3}, {0, 0, -1});
        EXPECT_EQ(hit.found, frame != 1) << frame;
    }
}

TEST(GltfMorph, AnimatedWeightsMoveTheMesh) {
    GltfBuilder file = morphedSquare();
    const int node = file.root({{"mesh", 0}});
    file.animate(node, "weights", "LINEAR", {0, 1}, {0, 0, 1, 0.5});
    const int still = file.root({{"mesh", 0}, {"translation", {9, 0, 0}}, {"weights", {7, 0}}});
    file.animate(still, "weights", "STEP", {0, 1}, {0, 0, 0, 0});
    EXPECT_EQ(loadGlb(file).triangles.size(), 2u);
    const TriangleMesh half = loadGlb(file, {.stillAt = 0.5});
    EXPECT_EQ(half.triangles.size(), 4u);
    expectNear(vertices(half)[2], {1.5, 1, 0.5});
    expectNear(vertices(half)[6], {10, 1, 0});
    // Cubic keys of two weights: in-tangents, values, out-tangents.
    GltfBuilder cubic = morphedSquare();
    cubic.animate(cubic.root({{"mesh", 0}}), "weights", "CUBICSPLINE", {0, 1},
                  {0, 0, 0, 0, 0, 0, 0, 0, 2, 1, 0, 0});
    expectNear(vertices(loadGlb(cubic, {.stillAt = 0.5}))[2], {2, 1, 1});
    cubic.json["animations"][0]["samplers"][0]["output"] = cubic.scalars({0, 1, 2});
    expectRefused(cubic, "3 numbers for 2 keys, expected 6 for each");
}

}  // namespace
}  // namespace shadowcache::test
