// PLY's triangle strips, colours of faces, names of colours, and what is not read of it.

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "common/import/load_mesh.h"
#include "common/mesh/looks.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

constexpr const char* kVertices =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
constexpr const char* kCorners = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

TriangleMesh loadPly(const std::string& header, const std::string& rows) {
    const TemporaryFolder folder;
    const auto path =
        folder.write("a.ply", "ply\nformat ascii 1.0\n" + header + "end_header\n" + rows);
    return loadMesh({&path, 1}, {});
}

TriangleMesh strips(const std::string& row) {
    return loadPly(
        std::string(kVertices) + "element tristrips 1\nproperty list int int vertex_indices\n",
        kCorners + row);
}

/// Sum of z of the triangles' normals, each as long as twice its area.
double turned(const TriangleMesh& mesh) {
    double sum = 0;
    for (const Vec3i& t : mesh.triangles) {
        const auto at = [&](int k) { return mesh.positions[static_cast<std::size_t>(t[k])]; };
        sum += static_cast<double>((at(1) - at(0)).cross(at(2) - at(0)).z);
    }
    return sum;
}

TEST(PlyFaces, StripsTurnTheSameWay) {
    const TriangleMesh mesh = strips("4 0 1 3 2\n");
    EXPECT_EQ(mesh.triangles.size(), 2u);
    EXPECT_NEAR(turned(mesh), 2, 1e-6);
    // -1 begins the next strip, whose first triangle turns as it stands.
    const TriangleMesh two = strips("7 0 1 2 -1 0 2 3\n");
    EXPECT_EQ(two.triangles.size(), 2u);
    EXPECT_NEAR(turned(two), 2, 1e-6);
}

TEST(PlyFaces, StripsOfBadCornersAreCounted) {
    const TriangleMesh mesh = strips("4 0 1 3 9\n");
    EXPECT_EQ(mesh.triangles.size(), 1u);
    EXPECT_EQ(mesh.report.badVertexFaces, 1u);
}

TEST(PlyFaces, FacesHaveColours) {
    const TriangleMesh mesh =
        loadPly(std::string(kVertices) +
                    "element face 2\nproperty list uchar int vertex_indices\nproperty uchar red\n"
                    "property uchar green\nproperty uchar blue\n",
                std::string(kCorners) + "3 0 1 2 255 0 0\n3 0 2 3 0 0 255\n");
    EXPECT_EQ(albedoAt(mesh, 0, 0.3f, 0.3f, Rgb(0.5f)), Rgb(1, 0, 0));
    EXPECT_EQ(albedoAt(mesh, 1, 0.3f, 0.3f, Rgb(0.5f)), Rgb(0, 0, 1));
    EXPECT_EQ(mesh.positions.size(), 6u);
    EXPECT_EQ(mesh.report.nonManifoldEdges, 0u);
}

TEST(PlyFaces, ColoursOfVerticesAreStronger) {
    const TriangleMesh mesh = loadPly(
        "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property uchar diffuse_red\nproperty uchar diffuse_green\n"
        "property uchar diffuse_blue\nelement face 1\n"
        "property list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n"
        "property uchar blue\n",
        "0 0 0 0 255 0\n1 0 0 0 255 0\n1 1 0 0 255 0\n3 0 1 2 255 0 0\n");
    EXPECT_EQ(albedoAt(mesh, 0, 0.3f, 0.3f, Rgb(0.5f)), Rgb(0, 1, 0));
    EXPECT_EQ(mesh.report.leftOut.count("colours of the faces (the vertices have their own)"), 1u);
}

TEST(PlyFaces, WhatIsNotReadIsNamed) {
    const auto said = [](const TriangleMesh& mesh) { return mesh.report.remarks; };
    const TriangleMesh mesh = loadPly(
        "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property float nx\nproperty float ny\nproperty float nz\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
        "property uchar alpha\nproperty float s\n"
        "element edge 1\nproperty int vertex1\nproperty int vertex2\n"
        "element face 1\nproperty list uchar int vertex_indices\n"
        "property list uchar float texcoord\nelement none 0\nproperty int i\n",
        "0 0 0 0 0 1 9 9 9 255 0\n1 0 0 0 0 1 9 9 9 255 0\n1 1 0 0 0 1 9 9 9 255 0\n0 1\n"
        "3 0 1 2 2 0 0\n");
    const std::map<std::string, std::size_t> wanted{
        {"properties of 'edge' left out (vertex1, vertex2)", 2},
        {"properties of 'face' left out (texcoord)", 1},
        {"properties of 'vertex' left out (alpha, s)", 2}};
    EXPECT_EQ(said(mesh), wanted);
    // A colour needs red, green and blue.
    EXPECT_EQ(said(loadPly("element vertex 3\nproperty float x\nproperty float y\n"
                           "property float z\nproperty uchar red\nproperty uchar green\n"
                           "element face 1\nproperty list uchar int vertex_indices\n",
                           "0 0 0 9 9\n1 0 0 9 9\n1 1 0 9 9\n3 0 1 2\n"))
                  .at("properties of 'vertex' left out (red, green)"),
              2u);
    std::string many = kVertices;
    for (int i = 0; i < 20; ++i) many += "property float f" + std::to_string(i) + "\n";
    std::string rows;
    for (const char* corner : {"0 0 0", "1 0 0", "1 1 0", "0 1 0"}) {
        rows += corner;
        for (int i = 0; i < 20; ++i) rows += " 0";
        rows += "\n";
    }
    EXPECT_EQ(said(loadPly(many + "element face 1\nproperty list uchar int vertex_indices\n",
                           rows + "3 0 1 2\n"))
                  .at("properties of 'vertex' left out (f0, f1, f2, f3, f4, f5, f6, f7, ...)"),
              20u);
    EXPECT_TRUE(said(strips("4 0 1 3 2\n")).empty());
}

}  // namespace
}  // namespace shadowcache::test
