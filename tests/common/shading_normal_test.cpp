// Shading normals: read from every format, made by crease angle, interpolated, and the smooth
// surface that they stand for.

#include "common/mesh/shading_normal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/import/load_mesh.h"
#include "common/mesh/mesh_fingerprint.h"
#include "common/mesh/placed_mesh.h"
#include "common/mesh/smooth_normals.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/mesh_files.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_scenes.h"

namespace shadowcache::test {
namespace {

TriangleMesh loadShaded(const std::filesystem::path& path, MeshOptions options = {}) {
    options.shadingNormals = true;
    return loadMesh({&path, 1}, options);
}

TriangleMesh loadText(const std::string& name, const std::string& bytes,
                      const MeshOptions& options = {}) {
    const TemporaryFolder folder;
    return loadShaded(folder.write(name, bytes), options);
}

/// At the middle of a triangle of the world, seen from the side that `towards` points to.
Vec3f middleNormal(const TriangleMesh& mesh, std::uint32_t number, const Vec3f& towards) {
    const Vec3f n = placedNormal(mesh, number);
    return shadingNormal(mesh, number, 1.0f / 3, 1.0f / 3, n.dot(towards) < 0 ? -n : n);
}

void expectNormal(const Vec3f& found, const Vec3d& wanted) {
    const Vec3d unit = wanted.normalized();
    EXPECT_LT((Vec3d(found) - unit).length(), 1e-6) << found << ", wanted " << unit;
}

/// The square of every format, with the normal (3, 0, 4) at every vertex.
TEST(ShadingNormals, OfEveryFormat) {
    std::string ply = squarePlyText();
    const auto replace = [&](const std::string& what, const std::string& by) {
        ply.replace(ply.find(what), what.size(), by);
    };
    replace("property float z\n",
            "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n");
    replace("0 0 0\n1 0 0\n1 1 0\n0 1 0\n", "0 0 0 3 0 4\n1 0 0 3 0 4\n1 1 0 3 0 4\n0 1 0 3 0 4\n");
    std::string om = squareOm();
    om += bytesOf(std::uint16_t{0x1620});  // vertex normals, 3 floats of 32 bits
    for (int i = 0; i < 4; ++i) om += bytesOf(std::array<float, 3>{3, 0, 4});
    GltfBuilder gltf;
    const int positions = gltf.vectors({kSquareCorners.begin(), kSquareCorners.end()});
    const int normals = gltf.vectors({3, 0, 4, 3, 0, 4, 3, 0, 4, 3, 0, 4});
    const int indices = gltf.accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, "SCALAR", 1);
    gltf.mesh(
        {{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}, {"indices", indices}});
    gltf.root({{"mesh", 0}});
    const std::pair<const char*, std::string> files[] = {
        {"a.obj",
         "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 3 0 4\nf 1//1 2//1 3//1\n"
         "f 1/7/-1 3/8/-1 4/9/-1\n"},
        {"a.off",
         "NOFF\n4 2 0\n0 0 0 3 0 4\n1 0 0 3 0 4\n1 1 0 3 0 4\n0 1 0 3 0 4\n3 0 1 2\n"
         "3 0 2 3\n"},
        {"a.ply", ply},
        {"a.om", om},
        {"a.glb", gltf.glb()}};
    for (const auto& [name, bytes] : files) {
        SCOPED_TRACE(name);
        const TriangleMesh mesh = loadText(name, bytes);
        ASSERT_EQ(mesh.cornerNormals.size(), 2u);
        EXPECT_EQ(mesh.report.badNormals, 0u);
        for (std::uint32_t i = 0; i < 2; ++i) {
            expectNormal(middleNormal(mesh, i, {0, 0, 1}), {3, 0, 4});
            expectNormal(middleNormal(mesh, i, {0, 0, -1}), {-3, 0, -4});
        }
        // One cache serves both.
        EXPECT_EQ(fingerprint(mesh), fingerprint(loadText("b.obj", squareObj())));
        const TemporaryFolder folder;
        const auto path = folder.write(name, bytes);
        EXPECT_TRUE(loadMesh({&path, 1}, {}).normals.empty());
    }
}

TEST(ShadingNormals, TurnWithAxesNodesAndInstances) {
    MeshOptions zUp;
    zUp.zUp = true;
    zUp.scale = 100;
    const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 3 0 4\nf 1//1 2//1 3//1\n";
    expectNormal(middleNormal(loadText("a.obj", obj, zUp), 0, {0, 1, 0}), {3, 4, 0});
    // A node that mirrors, then two that squash: normals turn by the inverse transpose.
    GltfBuilder file;
    const int positions = file.vectors({0, 0, 0, 1, 0, 0, 0, 1, 0});
    const int normals = file.vectors({3, 0, 4, 3, 0, 4, 3, 0, 4});
    file.mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}});
    GltfBuilder twice = file;
    file.root({{"mesh", 0}, {"scale", {-2, 1, 1}}});
    expectNormal(middleNormal(loadText("a.glb", file.glb()), 0, {0, 0, 1}), {-1.5, 0, 4});
    twice.root({{"mesh", 0}, {"scale", {2, 1, 1}}});
    twice.root({{"mesh", 0}, {"scale", {1, 1, 0.5}}, {"translation", {0, 0, 5}}});
    const TriangleMesh mesh = loadText("a.glb", twice.glb());
    ASSERT_EQ(mesh.instances.size(), 2u);
    expectNormal(middleNormal(mesh, 0, {0, 0, 1}), {1.5, 0, 4});
    expectNormal(middleNormal(mesh, 1, {0, 0, 1}), {3, 0, 8});
}

// A triangle with a bad corner has its geometric normal, and the report counts the normal.
TEST(ShadingNormals, BadOnesAreCountedAndReplaced) {
    for (const char* bad : {"vn 0 0 0", "vn nan 0 1", "vn inf 0 1"}) {
        const TriangleMesh mesh =
            loadText("a.obj", std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 3 0 4\n") + bad +
                                  "\nf 1//1 2//1 3//2\nf 2//1 4//1 3//1\n");
        EXPECT_EQ(mesh.report.badNormals, 1u) << bad;
        expectNormal(middleNormal(mesh, 0, {0, 0, 1}), {0, 0, 1});
        expectNormal(middleNormal(mesh, 1, {0, 0, 1}), {3, 0, 4});
    }
    const TriangleMesh outside =
        loadText("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 3 0 4\nf 1//1 2//9 3//1\n");
    EXPECT_EQ(outside.report.badNormals, 1u);
    expectNormal(middleNormal(outside, 0, {0, 0, 1}), {0, 0, 1});
    // At a right angle to the triangle.
    const TriangleMesh across =
        loadText("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nf 1//1 2//1 3//1\n");
    expectNormal(middleNormal(across, 0, {0, 0, 1}), {0, 0, 1});
    // Huge and tiny ones are as good as others.
    const TriangleMesh sizes =
        loadText("a.obj",
                 "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 3e300 0 4e300\nvn 3e-300 0 4e-300\n"
                 "f 1//1 2//2 3//1\n");
    EXPECT_EQ(sizes.report.badNormals, 0u);
    expectNormal(middleNormal(sizes, 0, {0, 0, 1}), {3, 0, 4});
}

TEST(SmoothNormals, FollowTheCreaseAngle) {
    TriangleMesh box;
    addBox(box, {0, 0, 0}, {1, 1, 1});
    TriangleMesh sharp = box, round = box;
    smoothNormals(sharp, 89);
    EXPECT_TRUE(sharp.normals.empty());
    smoothNormals(round, 90);
    // At each corner of the box three faces take the same angle.
    ASSERT_EQ(round.cornerNormals.size(), 12u);
    for (std::size_t i = 0; i < 12; ++i)
        for (int k = 0; k < 3; ++k) {
            const Vec3f corner =
                round.positions[static_cast<std::size_t>(round.triangles[i][k])] - Vec3f(0.5f);
            expectNormal(round.normals[static_cast<std::size_t>(round.cornerNormals[i][k])],
                         Vec3d(corner));
        }
    // Opposite winding is the other side.
    TriangleMesh fold;
    addTriangle(fold, {0, 0, 0}, {1, 0, 0}, {0, 1, 0.1f});
    addTriangle(fold, {0, 0, 0}, {1, 0, 0}, {0, -1, 0.1f});
    smoothNormals(fold, 60);
    EXPECT_TRUE(fold.normals.empty());
    std::swap(fold.triangles[1].y, fold.triangles[1].z);
    smoothNormals(fold, 60);
    EXPECT_FALSE(fold.normals.empty());
}

TEST(SmoothNormals, OfABallAreRadialAndGivenOnesAreKept) {
    TriangleMesh mesh;
    addSphere(mesh, {0, 0, 0}, 1, 24);
    mesh.normals.assign(1, Vec3f(0, 0, 1));
    mesh.cornerNormals.assign(mesh.triangles.size(), Vec3i(-1, -1, -1));
    mesh.cornerNormals[7] = Vec3i(0, 0, 0);
    smoothNormals(mesh, 40);
    EXPECT_EQ(mesh.cornerNormals[7], Vec3i(0, 0, 0));
    EXPECT_LT(mesh.normals.size(), 2 * mesh.positions.size()) << "corners share their normals";
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        for (int k = 0; i != 7 && k < 3; ++k) {
            const Vec3f& p = mesh.positions[static_cast<std::size_t>(mesh.triangles[i][k])];
            const int normal = mesh.cornerNormals[i][k];
            ASSERT_GE(normal, 0);
            EXPECT_GT(mesh.normals[static_cast<std::size_t>(normal)].dot(p.normalized()), 0.99f);
        }
}

/// Share of the places of a coarse ball with smooth normals whose shading normal sees a sun, but
/// whose shadow ray toward it is stopped.
double selfShadowed(bool offset) {
    TriangleMesh mesh;
    addSphere(mesh, {0, 0, 0}, 1, 8);
    smoothNormals(mesh, 60);
    const Scene scene(mesh);
    const Vec3f sun = Vec3f(0.6f, 0.5f, 0.3f).normalized();
    int lit = 0, stopped = 0;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (const auto& [u, v] : {std::pair(0.33f, 0.33f), {0.1f, 0.1f}, {0.8f, 0.1f}}) {
            const auto [a, b, c] = placedCorners(mesh, t);
            const Vec3f p(a + (b - a) * static_cast<double>(u) + (c - a) * static_cast<double>(v));
            const Vec3f side = scene.normal(t);
            if (shadingNormal(mesh, t, u, v, side).dot(sun) < 0.05f) continue;
            ++lit;
            RayPacket packet{};
            packet.set(0,
                       scene.rayOrigin(p, t, side) +
                           (offset ? smoothOffset(mesh, t, u, v, side) : Vec3f(0.0f)),
                       sun);
            stopped += scene.visibility(packet, 1) == 0 ? 1 : 0;
        }
    return static_cast<double>(stopped) / lit;
}

TEST(SmoothOffset, LeavesNoFacetsInTheTerminator) {
    EXPECT_LT(selfShadowed(true), 0.005);
    EXPECT_GT(selfShadowed(false), 0.03) << "control: from the facets themselves";
}

TEST(SmoothOffset, IsZeroOnFlatAndConcaveParts) {
    TriangleMesh mesh;
    addTriangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    EXPECT_EQ(smoothOffset(mesh, 0, 0.3f, 0.3f, {0, 0, 1}), Vec3f(0.0f));
    const auto tilted = [](float x, float y) { return Vec3f(x, y, 1).normalized(); };
    mesh.cornerNormals.assign(1, Vec3i(0, 1, 2));
    for (const auto& [x, y] : {std::pair(0.3f, 0.3f), {-0.3f, 0.0f}, {0.0f, -0.3f}})
        mesh.normals.push_back(tilted(x, y));
    EXPECT_EQ(smoothOffset(mesh, 0, 0.3f, 0.3f, {0, 0, 1}), Vec3f(0.0f));
    EXPECT_GT(smoothOffset(mesh, 0, 0.3f, 0.3f, {0, 0, -1}).length(), 0.05f)
        << "its back is convex";
}

TEST(SceneIsFree, SeesWhatLiesBetween) {
    TriangleMesh mesh;
    addFloor(mesh, 0.5f, -1, 1, -1, 1);
    const Scene scene(mesh);
    EXPECT_FALSE(scene.isFree({0, 0, 0}, {0, 0.6f, 0}));
    EXPECT_TRUE(scene.isFree({0, 0, 0}, {0, 0.4f, 0}));
    EXPECT_TRUE(scene.isFree({0, 0, 0}, {0, -9, 0}));
}

}  // namespace
}  // namespace shadowcache::test
