// Panes: light passes them straight, tinted, but for what they mirror; closed forms of what does.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "common/base/hash.h"
#include "common/mesh/mesh_fingerprint.h"
#include "render/frame/integrator.h"
#include "tests/support/glazed_floor.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

using test::glass, test::glazedFloor, test::passed;

/// What rays up from the floor, at an angle, carry of a white light: by channel.
std::array<std::vector<double>, 3> carried(const Scene& scene, double cosine, int count) {
    std::array<std::vector<double>, 3> found;
    const double sine = std::sqrt(1 - cosine * cosine);
    for (int i = 0; i < count; ++i) {
        const double turn = 2 * kPi * toUnit(hashWords(static_cast<std::uint64_t>(i), 1));
        const Vec3f origin = Vec3f(Vec3d(0, 0.9, 0) - scene.mesh().origin);
        const Vec3f w(static_cast<float>(sine * std::cos(turn)), static_cast<float>(cosine),
                      static_cast<float>(sine * std::sin(turn)));
        RayPacket packet{};
        packet.set(0, origin, w);
        Hit hit;
        scene.meet(packet, 1, &hit);
        const bool visible = scene.visibility(packet, 1) == 1;
        EXPECT_EQ(visible, !hit.found);
        EXPECT_EQ(visible, !scene.intersect(origin, w).found);
        const Rgb tint = scene.tint(origin, w);
        if (visible) {
            EXPECT_EQ(hit.tint, tint);
        }
        for (int c = 0; c < 3; ++c)
            found[static_cast<std::size_t>(c)].push_back(visible ? static_cast<double>(tint[c])
                                                                 : 0.0);
    }
    return found;
}

struct Sheets {
    std::string name;
    int count;
    double cosine;
    bool shared;
};

class PaneOf : public testing::TestWithParam<Sheets> {};

// With its control: 6 % more.
TEST_P(PaneOf, LetsPassWhatItDoesNotMirror) {
    const auto& [name, count, cosine, shared] = GetParam();
    const Rgb green(0.5f, 0.9f, 0.6f);
    const TriangleMesh mesh = glazedFloor(count, glass(green, 0.8f), shared);
    const Scene scene(mesh);
    const auto found = carried(scene, cosine, 40000);
    const double level = test::significance(24);
    for (int c = 0; c < 3; ++c) {
        const auto& values = found[static_cast<std::size_t>(c)];
        const double wanted = std::pow(0.8 * static_cast<double>(green[c]) * passed(cosine), count);
        EXPECT_GT(test::meanPValue(values, wanted), level) << c;
        EXPECT_LT(test::meanPValue(values, 1.06 * wanted), level) << c;
    }
}

INSTANTIATE_TEST_SUITE_P(Sheets, PaneOf,
                         testing::Values(Sheets{"one", 1, 0.999, false},
                                         Sheets{"two", 2, 0.999, false},
                                         Sheets{"oblique", 1, 0.4, false},
                                         Sheets{"placed", 2, 0.4, true}),
                         [](const auto& sheets) { return sheets.param.name; });

TEST(Pane, OfClearGlassIsSeenThroughAtAllButGrazingAngles) {
    const TriangleMesh mesh = glazedFloor(1, glass(Rgb(1)));
    const Scene scene(mesh);
    EXPECT_FALSE(scene.tints());
    const auto grazing = carried(scene, 0.04, 4000)[0];
    double sum = 0;
    for (const double one : grazing) sum += one;
    EXPECT_NEAR(sum / 4000, passed(0.04), 0.03);
}

/// Irradiance at the floor's middle by a sky of radiance 1 of which a part is seen through sheets.
Rgb throughSheets(const Vec3d& from, int sheets, const Rgb& color) {
    constexpr int kCells = 400;
    Vec3d sum(0);
    for (int i = 0; i < kCells; ++i)
        for (int k = 0; k < kCells; ++k) {
            // Uniform in the projected hemisphere.
            const double u = (i + 0.5) / kCells, turn = 2 * kPi * (k + 0.5) / kCells;
            const double cosine = std::sqrt(1 - u), sine = std::sqrt(u);
            Vec3d part(1);
            for (int s = 0; s < sheets; ++s) {
                const double reach = (1 + 0.1 * s - from.y) / cosine;
                const double x = from.x + reach * sine * std::cos(turn),
                             z = from.z + reach * sine * std::sin(turn);
                if (std::max(std::abs(x), std::abs(z)) > 3) continue;
                for (int c = 0; c < 3; ++c)
                    part[c] *= passed(cosine) * static_cast<double>(color[c]);
            }
            sum += part;
        }
    return Rgb(sum * (kPi / (kCells * kCells)));
}

// Bake and render see the same, in the glass's colour. With its control: 3 % more.
TEST(Pane, TintsTheLightOfAllEstimators) {
    const Rgb amber(0.9f, 0.6f, 0.2f);
    const test::World world(glazedFloor(2, glass(amber)), test::constantMap(Rgb(1)));
    const ShadingPoint point = test::pointAlong(world.scene, {0, 0.25f, 0}, {0, -1, 0});
    const Rgb truth = throughSheets(point.place.position, 2, amber);
    const double level = test::significance(3);
    for (const std::string name : {"mis", "paper", "cache"}) {
        const auto estimator = findEstimator(name).make(world.context(), {});
        const test::Estimates found = test::runEstimator(*estimator, point, 64, 2000);
        EXPECT_GT(test::agreementPValue(found, truth), level) << name << " " << found.mean(0);
        EXPECT_LT(test::agreementPValue(found, truth * 1.03f), level) << name;
    }
}

// A lamp above the glass. With its control: 5 % more.
TEST(Pane, TintsTheLightOfALampBehindIt) {
    const Rgb blue(0.3f, 0.5f, 0.9f);
    TriangleMesh mesh = glazedFloor(1, glass(blue));
    constexpr double kHeight = 2, kHalf = 0.2;
    const auto h = static_cast<float>(kHalf);
    test::addFloor(mesh, kHeight, -h, h, -h, h);
    mesh.materials.push_back({});
    mesh.materials[2].finish.emission = Rgb(3);
    mesh.parts.push_back({4, 2, 2});
    const test::World world(mesh, test::constantMap(Rgb(0)));
    const ShadingPoint point = test::pointAlong(world.scene, {0.6f, 0.25f, 0}, {0, -1, 0});
    const Vec3d at = point.place.position;
    Vec3d sum(0);
    constexpr int kCells = 200;
    for (int i = 0; i < kCells; ++i)
        for (int k = 0; k < kCells; ++k) {
            const Vec3d way((2 * (i + 0.5) / kCells - 1) * kHalf - at.x, kHeight - at.y,
                            (2 * (k + 0.5) / kCells - 1) * kHalf - at.z);
            const double cosine = way.normalized().y;
            for (int c = 0; c < 3; ++c)
                sum[c] += 3 * static_cast<double>(blue[c]) * passed(cosine) * cosine * cosine /
                          way.length2() * (4 * kHalf * kHalf / (kCells * kCells));
        }
    const Rgb truth(sum);
    const double level = test::significance(2);
    for (const char* name : {"mis", "cache"}) {
        const auto estimator = findEstimator(name).make(world.context(), {});
        const test::Estimates found = test::runEstimator(*estimator, point, 16, 2000);
        EXPECT_GT(test::agreementPValue(found, truth), level) << name << " " << found.mean(0);
        EXPECT_LT(test::agreementPValue(found, truth * 1.05f), level) << name;
    }
}

/// Mean colour of a film that looks down at a slant through a sheet onto the floor.
Rgb filmThrough(const Material& pane, const Rgb& floor) {
    TriangleMesh mesh = glazedFloor(1, pane);
    mesh.materials[0].finish.unlit = true;
    mesh.materials[0].albedo = floor;
    const Scene scene(mesh);
    const Environment environment = test::environmentOf(test::constantMap(Rgb(1)));
    const auto estimator = findEstimator("mis").make({scene, environment, nullptr});
    RenderOptions options;
    options.width = options.height = 32;
    options.samples = 4;
    options.cameraRays = 16;
    RenderStats stats;
    const Film film =
        render({*estimator, lookAt({0, 2.5, 1.5}, {0, 0, 0}, {0, 1, 0}, 0.1), 1, options}, stats);
    Vec3d sum(0);
    for (const Pixel& pixel : film.pixels) sum += Vec3d(pixel.color) / 1024;
    return Rgb(sum);
}

// What clear glass does not let pass it mirrors: between equal lights it is not seen.
TEST(Pane, OfClearGlassBetweenEqualLightsIsInvisible) {
    const Rgb seen = filmThrough(glass(Rgb(1)), Rgb(1));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], 1, 0.01f);
}

TEST(Pane, MirrorsTheSkyAndTintsTheFloor) {
    const Rgb red(0.8f, 0.1f, 0.1f);
    const double cosine = 2.5 / std::hypot(2.5, 1.5);
    const Rgb clear = filmThrough(glass(red), Rgb(1));
    // Half of the base scatters the sky's light, as opaque things do.
    const Rgb milky = filmThrough(glass(red, 0.5f), Rgb(0));
    for (int c = 0; c < 3; ++c) {
        const double through = static_cast<double>(red[c]) * passed(cosine);
        EXPECT_NEAR(static_cast<double>(clear[c]), 1 - passed(cosine) + through, 0.015);
        EXPECT_NEAR(static_cast<double>(milky[c]), 1 - passed(cosine) + through / 2, 0.02);
    }
}

TEST(Pane, IsKnownByTheFingerprint) {
    const TriangleMesh clear = glazedFloor(1, glass(Rgb(1)));
    std::vector<std::uint64_t> prints{fingerprint(clear)};
    TriangleMesh other = clear;
    other.materials[1].finish.transmission = 0.9f;
    prints.push_back(fingerprint(other));
    other.materials[1].finish.transmission = 0;
    prints.push_back(fingerprint(other));
    other = clear;
    other.materials[1].albedo = Rgb(0.9f, 1, 1);
    prints.push_back(fingerprint(other));
    other = clear;
    other.materials[1].finish.gloss->ior = 1.6f;
    prints.push_back(fingerprint(other));
    other = clear;
    other.colors.assign(other.positions.size(), Rgb(0.5f));
    prints.push_back(fingerprint(other));
    std::ranges::sort(prints);
    EXPECT_EQ(std::ranges::adjacent_find(prints), prints.end());
    // Neither what others than panes look like nor what blurs their mirrors decides where rays go.
    other = clear;
    other.materials[0].albedo = Rgb(0.1f);
    other.materials[1].finish.gloss->roughness = 0.3f;
    EXPECT_EQ(fingerprint(other), fingerprint(clear));
}

}  // namespace
}  // namespace shadowcache
