// Surfaces that blend: rays pass them with the probability that their opacity leaves.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "common/base/hash.h"
#include "common/math/affine.h"
#include "render/frame/integrator.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

constexpr float kOpacity = 0.3f;

/// A floor, and veils over it that blend; they are instances of one or stand there themselves.
TriangleMesh veiledFloor(int veils, bool shared) {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -1, 1, -1, 1);
    const int copies = shared ? 1 : veils;
    for (int k = 0; k < copies; ++k)
        test::addFloor(mesh, shared ? 0.0f : 1 + 0.1f * static_cast<float>(k), -3, 3, -3, 3);
    mesh.materials.resize(2);
    mesh.materials[1].blends = true;
    mesh.materials[1].opacity = kOpacity;
    mesh.parts = {{0, 2, 0}, {2, static_cast<std::uint32_t>(2 * copies), 1}};
    if (!shared) return mesh;
    mesh.firstSharedPart = 1;
    for (int k = 0; k < veils; ++k) {
        MeshInstance veil;
        veil.firstPart = veil.partCount = 1;
        veil.toWorld.position = {0, 1 + 0.1 * k, 0};
        veil.firstPlaced = static_cast<std::uint32_t>(2 + 2 * k);
        veil.triangleCount = 2;
        mesh.instances.push_back(veil);
    }
    return mesh;
}

/// Ray number `i` up from the floor: through all veils.
Vec3f direction(int i) {
    const auto u = static_cast<float>(toUnit(hashWords(static_cast<std::uint64_t>(i), 1))),
               v = static_cast<float>(toUnit(hashWords(static_cast<std::uint64_t>(i), 2)));
    return Vec3f(u - 0.5f, 1, v - 0.5f).normalized();
}

/// 1 for each ray that passes, 0 for the others; by packets, which must agree with streams and
/// distances.
std::vector<double> passes(const Scene& scene, int count) {
    std::vector<double> passed;
    const Vec3f origin = Vec3f(Vec3d(0, 0.01, 0) - scene.mesh().origin);
    for (int i = 0; i < count; i += RayPacket::kSize) {
        RayPacket packet{};
        RayStream stream{};
        for (int k = 0; k < RayPacket::kSize; ++k) {
            const Vec3f w = direction(i + k);
            packet.set(k, origin, w);
            for (int a = 0; a < 3; ++a) {
                stream.origin[a][k] = origin[a];
                stream.direction[a][k] = w[a];
            }
            stream.reach[k] = std::numeric_limits<float>::infinity();
        }
        const std::uint32_t bits = scene.visibility(packet, RayPacket::kSize);
        std::array<float, RayPacket::kSize> distances{};
        scene.distances(packet, RayPacket::kSize, distances.data());
        scene.trace(stream, RayPacket::kSize);
        for (std::size_t k = 0; k < RayPacket::kSize; ++k) {
            const bool visible = (bits >> k) & 1;
            EXPECT_EQ(visible, std::isinf(distances[k]));
            EXPECT_EQ(visible, stream.reach[k] >= 0);
            EXPECT_EQ(visible, !scene.intersect(origin, direction(i + static_cast<int>(k))).found);
            passed.push_back(visible ? 1 : 0);
        }
    }
    return passed;
}

// Of one veil, and of three of which each has a chance of its own. With their control: 3 % more.
TEST(Blend, RaysPassByTheOpacity) {
    for (const bool shared : {false, true})
        for (const int veils : {1, 3}) {
            const TriangleMesh mesh = veiledFloor(veils, shared);
            const Scene scene(mesh);
            const std::vector<double> passed = passes(scene, 80000);
            const double wanted = std::pow(1 - static_cast<double>(kOpacity), veils);
            const double level = test::significance(4);
            EXPECT_GT(test::meanPValue(passed, wanted), level) << shared << veils;
            EXPECT_LT(test::meanPValue(passed, 1.03 * wanted), level) << shared << veils;
        }
}

TEST(Blend, OpaqueAndInvisibleOnesAreExact) {
    for (const float opacity : {0.0f, 1.0f}) {
        TriangleMesh mesh = veiledFloor(1, false);
        mesh.materials[1].opacity = opacity;
        const Scene scene(mesh);
        for (const double passed : passes(scene, 800)) EXPECT_EQ(passed, opacity == 0 ? 1 : 0);
    }
}

// Bake and render see the same: all estimators have the light that the veil leaves. With its
// control: 3 % more.
TEST(Blend, LightIsDimmedByTheOpacity) {
    const test::World world(veiledFloor(1, false), test::constantMap(Rgb(1, 0.5f, 2)));
    const ShadingPoint point = test::pointAlong(world.scene, {0, 0.25f, 0}, {0, -1, 0});
    const std::vector<Vec3d> veil{{-3, 1, -3}, {3, 1, -3}, {3, 1, 3}, {-3, 1, 3}};
    const double hidden = static_cast<double>(kOpacity) *
                          test::polygonIrradiance(point.place.position, Vec3d(0, 1, 0), veil);
    const Rgb truth = Rgb(1, 0.5f, 2) * static_cast<float>(kPi - hidden);
    const std::vector<std::string> names{"mis", "paper", "cache"};
    for (const std::string& name : names) {
        const auto estimator = findEstimator(name).make(world.context(), {});
        const double level = test::significance(3);
        const test::Estimates found = test::runEstimator(*estimator, point, 64, 2000);
        EXPECT_GT(test::agreementPValue(found, truth), level) << name << " " << found.mean(0);
        EXPECT_LT(test::agreementPValue(found, truth * 1.03f), level) << name;
    }
}

// The camera sees straight through: a pixel has the veil's colour by its opacity.
TEST(Blend, CameraRaysPassByTheOpacity) {
    TriangleMesh mesh = veiledFloor(1, false);
    mesh.materials[0].finish.unlit = mesh.materials[1].finish.unlit = true;
    mesh.materials[0].albedo = Rgb(1, 0, 0);
    mesh.materials[1].albedo = Rgb(0, 1, 0);
    const Scene scene(mesh);
    const Environment environment = test::environmentOf(test::constantMap(Rgb(1, 1, 1)));
    const auto estimator = findEstimator("mis").make({scene, environment, nullptr});
    RenderOptions options;
    options.width = options.height = 40;
    options.samples = 1;
    options.cameraRays = 16;
    RenderStats stats;
    const Film film =
        render({*estimator, lookAt({0, 2.5, 0}, {0, 0, 0}, {0, 0, 1}, 0.3), 1, options}, stats);
    double veil = 0, floor = 0;
    for (const Pixel& pixel : film.pixels) {
        veil += static_cast<double>(pixel.color.y) / 1600;
        floor += static_cast<double>(pixel.color.x) / 1600;
    }
    EXPECT_NEAR(veil, static_cast<double>(kOpacity), 0.01);
    EXPECT_NEAR(floor, 1 - static_cast<double>(kOpacity), 0.01);
}

}  // namespace
}  // namespace shadowcache
