// Where rays begin: beside their triangle for Embree, and no farther than rounding demands.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/mesh/placed_mesh.h"
#include "common/trace/scene.h"

namespace shadowcache {
namespace {

using Random = std::mt19937;

double uniform(Random& random, double least, double most) {
    return least + (most - least) * (static_cast<double>(random() >> 8) * 0x1p-24);
}

Vec3d inCube(Random& random, double half) {
    return {uniform(random, -half, half), uniform(random, -half, half),
            uniform(random, -half, half)};
}

Vec3d direction(Random& random) {
    for (;;) {
        const Vec3d v = inCube(random, 1);
        if (v.length() > 0.1 && v.length() < 1) return v.normalized();
    }
}

/// One triangle of about `size`, `far` from the origin.
TriangleMesh triangle(Random& random, double size, double far) {
    TriangleMesh mesh;
    const Vec3d at = inCube(random, far);
    for (int k = 0; k < 3; ++k) mesh.positions.emplace_back(at + inCube(random, size));
    mesh.triangles.emplace_back(0, 1, 2);
    return mesh;
}

/// Makes an instance of it, turned, stretched and moved back to about where it was.
void place(Random& random, double far, TriangleMesh& mesh) {
    MeshInstance instance;
    const Vec3d x = direction(random), y = x.cross(direction(random)).normalized();
    const double scale = std::exp(uniform(random, -3, 3));
    instance.toWorld.axis = {x * scale, y * (scale * uniform(random, 0.5, 2)), x.cross(y) * -scale};
    instance.toWorld.position = inCube(random, far);
    instance.partCount = instance.triangleCount = 1;
    mesh.parts = {{0, 0, -1}, {0, 1, -1}};
    instance.firstPart = 1;
    mesh.firstSharedPart = 1;
    mesh.instances = {instance};
}

/// Share of the rays from places on a triangle that meet it.
///
/// @param share  of the way from the place to the origin for rays
double stopped(double size, double far, bool placed, double share = 1) {
    Random random(1);
    int met = 0, all = 0;
    for (int i = 0; i < 60; ++i) {
        TriangleMesh mesh = triangle(random, size, far);
        if (placed) place(random, far, mesh);
        const Scene scene(mesh);
        for (int k = 0; k < 40; ++k) {
            const double root = std::sqrt(uniform(random, 0, 1)), v = root * uniform(random, 0, 1);
            const auto [a, b, c] = placedCorners(mesh, 0);
            const Vec3f p(a * (1 - root) + b * (root - v) + c * v);
            const Vec3f side = scene.normal(0) * (k % 2 ? -1.0f : 1.0f);
            const Vec3f from = p + (scene.rayOrigin(p, 0, side) - p) * static_cast<float>(share);
            RayPacket rays{};
            for (int ray = 0; ray < 8; ++ray) {
                Vec3f way(direction(random));
                if (way.dot(side) < 0) way = -way;
                rays.set(ray, from, way);
            }
            const std::uint32_t free = scene.visibility(rays, 8);
            for (int ray = 0; ray < 8; ++ray) met += (free >> ray & 1) == 0 ? 1 : 0;
            all += 8;
        }
    }
    return static_cast<double>(met) / all;
}

TEST(RayOrigin, NoRayMeetsItsTriangle) {
    for (const double scale : {1e-6, 1.0, 1e7})
        for (const double far : {0.0, 1.0, 1000.0})
            for (const bool placed : {false, true})
                EXPECT_EQ(stopped(scale, scale * far, placed), 0) << scale << ' ' << far << placed;
    EXPECT_GT(stopped(1, 1000, false, 0.01), 0.01) << "control: a hundredth of the way";
}

/// A floor of any size rounds nothing off its height.
TEST(RayOrigin, FollowsTheRoundingOfThePlace) {
    TriangleMesh mesh;
    for (const auto& [x, z] : {std::pair(-5e3f, -5e3f), {5e3f, 5e3f}, {5e3f, -5e3f}})
        mesh.positions.emplace_back(x, 1, z);
    mesh.triangles.emplace_back(0, 1, 2);
    const Scene scene(mesh);
    const auto offset = [&](const Vec3f& at) { return scene.rayOrigin(at, 0, {0, 1, 0}).y - 1; };
    EXPECT_GT(offset({1, 1, -2}), 0);
    EXPECT_LT(offset({1, 1, -2}), 1e-5f);
    EXPECT_LT(offset({4e3f, 1, -4.5e3f}), 1e-5f);
}

/// A wall along an axis at `height`, before one ray from each of many places to points of it.
///
/// @param bare  by the difference of the two places alone
/// @return share of the rays that are stopped
double stoppedAtTheirEnd(float height, bool bare) {
    TriangleMesh mesh;
    mesh.positions = {{height, -2, -2}, {height, 2, -2}, {height, 2, 2}, {height, -2, 2}};
    mesh.triangles.emplace_back(0, 1, 2);
    mesh.triangles.emplace_back(0, 2, 3);
    const Scene scene(mesh);
    Random random(1);
    int stopped = 0;
    constexpr int kRays = 20000;
    const Vec3f side(-1, 0, 0);
    const auto x = static_cast<double>(height);
    for (int i = 0; i < kRays; ++i) {
        const double y = uniform(random, -2, 2), z = uniform(random, -2, 2);
        const auto number = static_cast<std::uint32_t>(z > y ? 1 : 0);
        const Vec3f to = scene.rayOrigin(Vec3f(Vec3d(x, y, z)), number, side);
        const Vec3f from(Vec3d(x - std::exp(uniform(random, -4, 3)), uniform(random, -9, 9),
                               uniform(random, -9, 9)));
        if (!scene.isFree(from, bare ? to - from : wayBetween(from, to, side))) ++stopped;
    }
    return stopped / static_cast<double>(kRays);
}

// A ray to a place is not stopped by the surface of that place, whatever its coordinates: they may
// be next to nothing, while those of the ray's origin are not.
TEST(WayBetween, IsNotStoppedByTheSurfaceAtItsEnd) {
    for (const float height : {0.0f, -0.0139231682f, 1e-4f, 0.3f, 7.0f, -113.7f, 4e3f})
        EXPECT_EQ(stoppedAtTheirEnd(height, false), 0) << height;
    // Control: the difference of the places alone ends in the surface.
    EXPECT_GT(stoppedAtTheirEnd(0, true), 0.1);
    EXPECT_GT(stoppedAtTheirEnd(-0.0139231682f, true), 0.1);
}

}  // namespace
}  // namespace shadowcache
