// The default spacing: what it makes of clutter, and of faces that are there many times.

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "bake/core/default_spacing.h"
#include "bake/core/placement.h"
#include "bake/core/repeated_triangles.h"
#include "bake/core/surface_count.h"
#include "common/base/hash.h"

namespace shadowcache {
namespace {

constexpr std::uint32_t kTriangles = 250000;

/// Small triangles strewn over a cube. Each lies in a plane across one of `axes` axes.
TriangleMesh strewn(std::uint32_t axes) {
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < kTriangles; ++i) {
        Vec3f corner(0, 0, 0);
        for (int k = 0; k < 3; ++k)
            corner[k] = static_cast<float>(toUnit(hashWords(i, static_cast<std::uint64_t>(k))));
        const auto first = static_cast<int>(mesh.positions.size());
        mesh.positions.push_back(corner);
        for (std::uint32_t side = 1; side <= 2; ++side) {
            mesh.positions.push_back(corner);
            mesh.positions.back()[static_cast<int>((i % axes + side) % 3)] += 1e-4f;
        }
        mesh.triangles.emplace_back(first, first + 1, first + 2);
    }
    return mesh;
}

/// Items of the default spacing, about.
double itemsOf(const TriangleMesh& mesh) {
    SurfaceCount count;
    chooseSpacing(mesh, &count);
    return static_cast<double>(count.items);
}

TEST(DefaultSpacing, GivesClutterFewerItems) {
    const double parallel = itemsOf(strewn(1)), clutter = itemsOf(strewn(3));
    EXPECT_GT(parallel, 200000);
    EXPECT_LT(clutter, 0.5 * parallel);
}

/// The square [0, 1] x [0, 1], and its second triangle `copies` times, each from another corner on.
TriangleMesh squareWithCopies(int copies) {
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0}};
    mesh.triangles.emplace_back(0, 1, 2);
    mesh.triangles.emplace_back(0, 2, 3);
    constexpr std::array<Vec3i, 3> kTurned{Vec3i(4, 2, 3), Vec3i(2, 3, 0), Vec3i(0, 3, 2)};
    for (int i = 0; i < copies; ++i)
        mesh.triangles.push_back(kTurned[static_cast<std::size_t>(i) % kTurned.size()]);
    mesh.report.duplicates = static_cast<std::size_t>(copies);
    return mesh;
}

TEST(DefaultSpacing, IgnoresCopiesOfAFace) {
    const TriangleMesh once = squareWithCopies(0), often = squareWithCopies(466);
    const double spacing = chooseSpacing(once);
    EXPECT_EQ(chooseSpacing(often), spacing);
    EXPECT_EQ(itemsOf(often), itemsOf(once));
    const auto fragments = [&](const TriangleMesh& mesh) {
        return placeFragments(mesh, VoxelFrame(mesh, spacing)).size();
    };
    EXPECT_EQ(fragments(often), fragments(once));
}

/// A mirrored copy of a single-sided triangle is its other side.
TEST(DefaultSpacing, OtherSidesAreNoCopies) {
    TriangleMesh mesh = squareWithCopies(466);
    mesh.materials.resize(1);
    mesh.materials[0].doubleSided = false;
    mesh.parts = {{0, static_cast<std::uint32_t>(mesh.triangles.size()), 0}};
    std::size_t kept = 0;
    for (const bool repeated : repeatedTriangles(mesh)) kept += repeated ? 0 : 1;
    EXPECT_EQ(kept, 3u);
}

}  // namespace
}  // namespace shadowcache
