// Every format gives the same square; every defect is counted and nothing is lost.

#include "common/mesh/mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "common/image/srgb.h"
#include "common/import/load_mesh.h"
#include "common/import/mesh_options.h"
#include "common/import/triangulate.h"
#include "common/mesh/mesh_fingerprint.h"
#include "tests/support/loaded_mesh.h"
#include "tests/support/mesh_files.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

TriangleMesh loadAll(const std::vector<std::filesystem::path>& files,
                     const MeshOptions& options = {}) {
    return loadMesh(files, options);
}

double area(const TriangleMesh& mesh) {
    double sum = 0.0;
    for (const Vec3i& t : mesh.triangles) {
        const auto p = [&](int corner) {
            return Vec3d(mesh.positions[static_cast<std::size_t>(t[corner])]);
        };
        sum += 0.5 * (p(1) - p(0)).cross(p(2) - p(0)).length();
    }
    return sum;
}

/// No triangle is lost in silence: what came in is what came out and what the report tells.
void expectAccounted(const MeshReport& r) {
    EXPECT_EQ(r.facesRead - r.polygons + r.trianglesFromPolygons,
              r.triangles + r.degenerate + r.badVertexFaces)
        << describe(r);
}

TEST(Mesh, EveryFormatGivesTheSameSquare) {
    const TemporaryFolder folder;
    const std::vector<std::filesystem::path> files{
        folder.write("a.obj", squareObj()),     folder.write("a.OFF", squareOff()),
        folder.write("t.ply", squarePlyText()), folder.write("b.ply", squarePly()),
        folder.write("b.stl", squareStl()),     folder.write("t.stl", squareStlText()),
        folder.write("a.om", squareOm())};
    const std::uint64_t expected = fingerprint(loadAll({files[0]}));
    for (const auto& file : files) {
        const TriangleMesh mesh = loadAll({file});
        EXPECT_EQ(mesh.triangles.size(), 2u) << file;
        EXPECT_EQ(mesh.positions.size(), 4u) << file;
        EXPECT_EQ(mesh.origin, Vec3d(0.5, 0.5, 0.0)) << file;
        EXPECT_DOUBLE_EQ(area(mesh), 1.0) << file;
        EXPECT_EQ(fingerprint(mesh), expected) << file;
        EXPECT_EQ(describe(mesh.report), "2 triangles") << file;
        expectAccounted(mesh.report);
    }
}

TEST(Mesh, ReadsHalfEdgesAndColorsOfOm2) {
    const TriangleMesh mesh = loadBytes("a.om", squareAndTriangleOm2());
    EXPECT_DOUBLE_EQ(area(mesh), 1.5);
    EXPECT_EQ(mesh.report.polygons, 1u);
    ASSERT_EQ(mesh.colors.size(), 5u);
    EXPECT_EQ(mesh.colors[0], Rgb(1.0f, 0.0f, srgbToLinear(128.0f / 255.0f)));
    expectAccounted(mesh.report);
}

TEST(Mesh, NamesWhatItDoesNotReadOfOm) {
    std::string om = squareOm();
    om += bytesOf(std::uint16_t{0x0e40});  // texture coordinates of vertices, 2 floats of 32 bits
    om += std::string(4 * 8, '\0');
    om += bytesOf(std::uint16_t{0x1088});  // colours of faces, 3 bytes
    om += std::string(2 * 3, '\7');
    EXPECT_EQ(describe(loadBytes("a.om", om).report),
              "2 triangles; 2 faces whose colours are left out; 4 vertices whose texture "
              "coordinates are left out");
}

TEST(Mesh, ReadsEveryFormOfObjFace) {
    const TriangleMesh mesh = loadBytes("a.obj",
                                        "v 0 0 0 1 0.5 0.25\r\nv 1 0 0\r\nvt 0 0\r\nvn 0 0 1\r\n"
                                        "v 1 1 +0\r\nv 0 1 0\r\no thing\r\ns off\r\n"
                                        "f 1/1/1 2/1/1 3/1/1\r\nf -4//1 -2//-1 \\\r\n-1//1\r\n"
                                        "f 1/1 2/1 4/1\r\nl 1 2\r\n");
    EXPECT_EQ(mesh.report.facesRead, 3u);
    EXPECT_DOUBLE_EQ(area(mesh), 1.5);
    ASSERT_EQ(mesh.colors.size(), 4u);
    EXPECT_EQ(mesh.colors[0], Rgb(1.0f, srgbToLinear(0.5f), srgbToLinear(0.25f)));
    EXPECT_EQ(mesh.colors[1], Rgb(1.0f, 1.0f, 1.0f));
}

TEST(Mesh, ReadsBigEndianDoublesListsAndForeignElementsOfPly) {
    const auto swapped = [](auto value) {
        std::string bytes = bytesOf(value);
        return std::string(bytes.rbegin(), bytes.rend());
    };
    std::string bytes =
        "ply\r\nformat binary_big_endian 1.0\r\ncomment x\r\nelement material 1\r\n"
        "property list uchar float values\r\nelement vertex 3\r\nproperty double x\r\n"
        "property uchar red\r\nproperty uchar green\r\nproperty uchar blue\r\n"
        "property double y\r\nproperty double z\r\nelement face 1\r\n"
        "property list uchar float texcoord\r\nproperty list ushort uint vertex_index\r\n"
        "end_header\r\n";
    bytes += '\2' + swapped(1.0f) + swapped(2.0f);
    for (const auto& [x, y] : {std::pair{1e6, 0.0}, {1e6 + 0.001, 0.0}, {1e6, 0.002}}) {
        bytes += swapped(x) + "\xff" + std::string(2, '\0') + swapped(y) + swapped(0.0);
    }
    bytes += '\1' + swapped(7.0f) + swapped(std::uint16_t{3});
    for (const std::uint32_t corner : {0u, 1u, 2u}) bytes += swapped(corner);

    const TriangleMesh mesh = loadBytes("a.ply", bytes);
    EXPECT_NEAR(area(mesh), 1e-6, 1e-12);  // far from the origin, yet not rounded to floats there
    ASSERT_EQ(mesh.colors.size(), 3u);
    EXPECT_EQ(mesh.colors[2], Rgb(1.0f, 0.0f, 0.0f));
}

TEST(Mesh, ReadsOffWithNormalsColorsAndComments) {
    const TriangleMesh mesh = loadBytes("a.off",
                                        "CNOFF # magic\n# counts\n3 1 3\n\n0 0 0 0 0 1 1 0 0 1\n"
                                        "1 0 0 0 0 1 0.5 0.5 0.5 1\n0 1 0 0 0 1 0 0 0\n"
                                        "3 0 1 2 10 20 30\n");
    ASSERT_EQ(mesh.colors.size(), 3u);
    EXPECT_EQ(mesh.colors[0], Rgb(1.0f, 0.0f, 0.0f));
    EXPECT_EQ(mesh.colors[1], Rgb(srgbToLinear(0.5f)));
}

TEST(Mesh, RotatesScalesAndJoins) {
    const TemporaryFolder folder;
    const auto first = folder.write("a.obj", "v 0 0 3\nv 1 0 3\nv 0 1 3\nf 1 2 3\n");
    const auto second = folder.write("b.obj", "v 0 0 5\nv 1 0 5\nv 0 1 5\nf 1 2 3\n");
    const TriangleMesh mesh = loadAll({first, second}, {.zUp = true, .scale = 2.0});
    ASSERT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(mesh.origin, Vec3d(1.0, 8.0, -1.0));
    EXPECT_EQ(mesh.origin + Vec3d(mesh.positions[2]), Vec3d(0.0, 6.0, -2.0));
    EXPECT_EQ(mesh.origin + Vec3d(mesh.positions[4]), Vec3d(2.0, 10.0, 0.0));
    EXPECT_EQ(fingerprint(mesh),
              fingerprint(loadAll({second, first}, {.zUp = true, .scale = 2.0})));
}

TEST(Mesh, CountsEveryDefectAndLosesNothing) {
    // Of 9 faces: a quad, a bad index, a NaN corner, a quad with an Inf corner, a face of two
    // corners, one with a corner twice, a sliver without area; vertices 8 and 9 are used by no good
    // face.
    const TriangleMesh mesh = loadBytes(
        "a.obj",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv nan 0 0\nv 0 1e999 0\nv 5 5 5\nv 6 6 6\n"
        "vn 0 0 -7\nf 1 2 3 4\nf 1 2 99\nf 1 2 6\nf 1 2 3 7\nf 1 2\nf 1 1 2\nf 1 2 5\n"
        "f 3 2 1\nf 1 2 4\n");
    const MeshReport& r = mesh.report;
    EXPECT_EQ(r.facesRead, 9u);
    EXPECT_EQ(r.polygons, 2u);
    EXPECT_EQ(r.trianglesFromPolygons, 4u);
    EXPECT_EQ(r.badVertexFaces, 4u);
    EXPECT_EQ(r.degenerate, 3u);
    EXPECT_EQ(r.triangles, 4u);
    EXPECT_EQ(r.duplicates, 1u);        // 3 2 1 lies on the quad's half
    EXPECT_EQ(r.nonManifoldEdges, 2u);  // 1-2 and the quad's diagonal 1-3
    EXPECT_EQ(r.unreferenced, 2u);
    expectAccounted(r);
    const std::string text = describe(r);
    for (const char* part : {"4 triangles", "2 n-gons", "without area", "duplicates",
                             "non-manifold", "without a face", "bad vertex"}) {
        EXPECT_NE(text.find(part), std::string::npos) << text;
    }
}

TEST(Mesh, CountsMixedWindingAcrossSeams) {
    // The shared edge's vertices are written twice: the second triangle runs along it the same way.
    const std::string head = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 0 1 -0\nv 1 1 0\nf 1 2 3\n";
    EXPECT_EQ(loadBytes("a.obj", head + "f 4 5 6\n").report.mixedWinding, 1u);
    EXPECT_EQ(loadBytes("a.obj", head + "f 5 4 6\n").report.mixedWinding, 0u);
}

TEST(Mesh, StlKeepsTrianglesThatShareBadOrEqualCorners) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const TriangleMesh mesh = loadBytes("a.stl", stl({{0, 0, 0, 1, 0, 0, 0, 1, 0},
                                                      {0, 0, 0, 0, 0, 0, 0, 1, 0},
                                                      {nan, 0, 0, 2, 0, 0, 0, 3, 0},
                                                      {0, 0, 1, 2, 0, 1, 0, 3, 1}}));
    EXPECT_EQ(mesh.report.triangles, 2u);
    EXPECT_EQ(mesh.report.degenerate, 1u);
    EXPECT_EQ(mesh.report.badVertexFaces, 1u);
    EXPECT_DOUBLE_EQ(area(mesh), 3.5);
    expectAccounted(mesh.report);
}

TEST(Mesh, FingerprintIgnoresNumberingOnly) {
    const std::string a = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\n";
    const std::string renumbered = "v 0 0 1\nv 0 1 0\nv 0 0 0\nv 1 0 0\nf 2 1 3\nf 2 3 4\n";
    const std::string moved = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1.0000001\nf 1 2 3\nf 1 3 4\n";
    const std::string shifted = "v 1 0 0\nv 2 0 0\nv 1 1 0\nv 1 0 1\nf 1 2 3\nf 1 3 4\n";
    const std::string rewired = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 2 3 4\n";
    const std::uint64_t expected = fingerprint(loadBytes("a.obj", a));
    EXPECT_EQ(fingerprint(loadBytes("a.obj", renumbered)), expected);
    for (const auto& other : {moved, shifted, rewired}) {
        EXPECT_NE(fingerprint(loadBytes("a.obj", other)), expected) << other;
    }
}

TEST(Triangulate, CoversConcavePolygonsOnce) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (std::size_t corners = 4; corners < 60; ++corners) {
        // A star around the origin in a tilted plane: its area is the sum over its rays.
        const Vec3d u = Vec3d(1, 2, 3).normalized();
        const Vec3d v = u.cross(Vec3d(0, 1, 0)).normalized();
        std::vector<Vec3d> polygon;
        for (std::size_t i = 0; i < corners; ++i) {
            const double angle = 2.0 * kPi * (static_cast<double>(i) + 0.9 * unit(random)) /
                                 static_cast<double>(corners);
            const double radius = 0.05 + unit(random);
            polygon.push_back((u * std::cos(angle) + v * std::sin(angle)) * radius +
                              Vec3d(1e3, 0, 0));
        }
        const Vec3d normal = u.cross(v);
        double expected = 0.0;
        for (std::size_t i = 0; i < corners; ++i) {
            expected += 0.5 * (polygon[i] - Vec3d(1e3, 0, 0))
                                  .cross(polygon[(i + 1) % corners] - Vec3d(1e3, 0, 0))
                                  .dot(normal);
        }
        std::vector<std::array<std::uint32_t, 3>> triangles;
        ASSERT_TRUE(triangulate(polygon, triangles));
        ASSERT_EQ(triangles.size(), corners - 2);
        double sum = 0.0;
        for (const auto& t : triangles) {
            const double part =
                0.5 *
                (polygon[t[1]] - polygon[t[0]]).cross(polygon[t[2]] - polygon[t[0]]).dot(normal);
            EXPECT_GE(part, -1e-9) << "a triangle of the wrong winding";
            sum += part;
        }
        EXPECT_NEAR(sum, expected, 1e-9 * expected) << corners;
    }
}

TEST(Triangulate, CutsPolygonsWithoutEarsIntoAsManyTriangles) {
    const std::vector<Vec3d> flat(6, Vec3d(1, 2, 3));
    const std::vector<Vec3d> bowTie{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};
    for (const auto& polygon : {flat, bowTie}) {
        std::vector<std::array<std::uint32_t, 3>> triangles;
        ASSERT_TRUE(triangulate(polygon, triangles));
        EXPECT_EQ(triangles.size(), polygon.size() - 2);
    }
}

}  // namespace
}  // namespace shadowcache::test
