// Parallel layers of surface in one voxel: they become items of their own.

#include "bake/core/depth_layers.h"

#include <gtest/gtest.h>

#include "common/cache/cache_items.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

constexpr double kLayerSpacing = 1;

/// Horizontal surfaces over all of the voxel around the origin.
TriangleMesh surfacesAt(const std::vector<float>& heights) {
    TriangleMesh mesh;
    for (const float y : heights) test::addFloor(mesh, y, -0.5f, 0.5f, -0.5f, 0.5f);
    return mesh;
}

/// Layers of the voxel around the origin, of the surface that faces up or down.
std::vector<std::vector<Piece>> layersOf(const TriangleMesh& mesh) {
    const VoxelFrame frame(mesh, kLayerSpacing);
    std::vector<Piece> pieces;
    const std::uint64_t key = frame.key({0, 0, 0});
    const Scene scene(mesh);
    for (const Fragment& f : placeFragments(mesh, frame)) {
        if (f.voxelKey != key) continue;
        const Vec3f n = scene.normal(f.triangle);
        pieces.push_back({f.triangle, f.area, n.y < 0 ? -n : n});
    }
    return splitDepthLayers(mesh, frame.box({0, 0, 0}), pieces);
}

TEST(DepthLayers, OfParallelSurfacesAreAsMany) {
    EXPECT_EQ(layersOf(surfacesAt({0.1f})).size(), 1u);
    const auto layers = layersOf(surfacesAt({0.3f, -0.2f, 0.1f}));
    ASSERT_EQ(layers.size(), 3u);
    // Two triangles each, from below.
    const std::uint32_t surface[] = {1, 2, 0};
    for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_EQ(layers[k].size(), 2u);
        for (const Piece& piece : layers[k]) EXPECT_EQ(piece.triangle / 2, surface[k]);
    }
}

TEST(DepthLayers, OfMoreSurfacesThanLayersKeepTheWidestGapsApart) {
    const auto layers = layersOf(surfacesAt({-0.4f, -0.39f, -0.2f, 0, 0.01f, 0.3f}));
    ASSERT_EQ(layers.size(), static_cast<std::size_t>(kMaxDepthLayers));
    EXPECT_EQ(layers[0].size(), 4u);
    EXPECT_EQ(layers[1].size(), 2u);
    EXPECT_EQ(layers[2].size(), 4u);
    EXPECT_EQ(layers[3].size(), 2u);
}

TEST(DepthLayers, AlmostTouchingSurfacesAreOne) {
    EXPECT_EQ(layersOf(surfacesAt({0, 1e-3f})).size(), 1u);
    EXPECT_EQ(layersOf(surfacesAt({0, 1e-2f})).size(), 2u);  // control
}

TEST(DepthLayers, SmallPartsAreNone) {
    for (const float side : {0.1f, 0.3f}) {
        TriangleMesh mesh = surfacesAt({0});
        test::addFloor(mesh, 0.2f, 0, side, -0.5f, 0.5f);
        EXPECT_EQ(layersOf(mesh).size(), side > 0.2f ? 2u : 1u);
    }
}

// A step is two layers, unless something leads from the one to the other.
TEST(DepthLayers, ConnectedSurfaceIsOne) {
    TriangleMesh step;
    test::addFloor(step, 0, -0.5f, -0.1f, -0.5f, 0.5f);
    test::addFloor(step, 0.2f, 0.1f, 0.5f, -0.5f, 0.5f);
    EXPECT_EQ(layersOf(step).size(), 2u);  // control
    test::addQuad(step, {-0.1f, 0, -0.5f}, {-0.1f, 0, 0.5f}, {0.1f, 0.2f, 0.5f},
                  {0.1f, 0.2f, -0.5f});
    EXPECT_EQ(layersOf(step).size(), 1u);
}

TEST(DepthLayers, BecomeItemsThatKnowTheirOwnSky) {
    TriangleMesh mesh = surfacesAt({-0.2f, 0.2f});
    const Scene scene(mesh);
    BakeOptions options;
    options.spacing = kLayerSpacing;
    const BakeResult result = bake(scene, options);
    constexpr int kUpper = 2;
    double visible[2] = {0, 0};
    int found = 0;
    for (std::size_t i = 0; i < result.items.size(); ++i) {
        const PatchCode code = PatchCode::of(result.items.patch[i]);
        if (result.items.voxel[i] != Vec3i(0, 0, 0) || code.side != kUpper) continue;
        ASSERT_EQ(code.subpatch, 0);
        const std::size_t cells = result.header.tiers().baseCells();
        double n = 0, d = 0;
        for (std::size_t c = i * cells; c < (i + 1) * cells; ++c)
            n += result.items.n[c], d += result.items.d[c];
        ASSERT_LT(code.layer, 2);
        visible[code.layer] = n / d;
        ++found;
    }
    ASSERT_EQ(found, 2);
    EXPECT_EQ(visible[1], 1.0);  // nothing above the upper one
    EXPECT_LT(visible[0], 0.7);
    EXPECT_GT(visible[0], 0.0);
}

}  // namespace
}  // namespace shadowcache
