// The default spacing: what it makes of clutter.

#include <gtest/gtest.h>

#include <vector>

#include "bake/core/options.h"
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

}  // namespace
}  // namespace shadowcache
