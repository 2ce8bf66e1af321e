// Lamps: irradiance by points, discs, suns, spots and areas in closed form; directions are drawn
// with the density that is claimed; a thousand of them are 32 emitters; rays meet those with an
// extent.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "common/emitters/emitters.h"
#include "common/emitters/lit_cap.h"
#include "common/mesh/lamp.h"
#include "tests/support/statistics.h"

namespace shadowcache {
namespace {

const Receiver kFloor{Vec3f(0, 0, 0), Vec3f(0, 1, 0)};

Lamp pointAt(const Vec3d& position, double radius = 0) {
    Lamp lamp;
    lamp.strength = Rgb(1, 2, 4);
    lamp.position = position;
    lamp.radius = radius;
    return lamp;
}

Lamp sunOf(const Vec3d& direction, double angle) {
    Lamp lamp;
    lamp.form = Lamp::Form::sun;
    lamp.strength = Rgb(1, 2, 4);
    lamp.direction = direction.normalized();
    lamp.angle = angle;
    return lamp;
}

Lamp spotAt(const Vec3d& position, bool smooth) {
    Lamp lamp = pointAt(position);
    lamp.direction = Vec3d(0, -1, 0);
    lamp.cone = LampCone{std::cos(0.2), std::cos(0.5), smooth};
    return lamp;
}

Lamp areaAt(Lamp::Form form, const Vec3d& position, double width, double height) {
    Lamp lamp = pointAt(position);
    lamp.form = form;
    lamp.direction = Vec3d(0, -1, 0);
    lamp.halfWidth = Vec3d(width / 2, 0, 0);
    lamp.halfHeight = Vec3d(0, 0, height / 2);
    return lamp;
}

TriangleMesh meshOf(std::vector<Lamp> lamps) {
    TriangleMesh mesh;
    mesh.lamps = std::move(lamps);
    return mesh;
}

Emitters emittersOfLamps(const TriangleMesh& mesh) {
    const TriangleMesh* const meshes[] = {&mesh};
    return Emitters(meshes);
}

/// Irradiance in green of the floor at 0.
double lit(const Lamp& lamp, const Receiver& at = kFloor) {
    const TriangleMesh mesh = meshOf({lamp});
    const Emitters emitters = emittersOfLamps(mesh);
    return emitters.empty() ? 0 : static_cast<double>(emitters.irradiance(0, at).irradiance.y);
}

TEST(CapCosine, IsTheIntegralOverWhatIsAboveTheHorizon) {
    constexpr int kSteps = 200000;
    for (const double cosine : {0.9, 0.05, 0.0, -0.05, -0.3})
        for (const double sineSquared : {0.01, 0.5, 1.0}) {
            const Vec3d axis(std::sqrt(1 - cosine * cosine), cosine, 0);
            double sum = 0;
            for (int i = 0; i < kSteps; ++i) {
                const Vec3d way = sampleCap(axis, sineSquared, (i + 0.5) / kSteps,
                                            std::fmod(i * 0.61803398875, 1.0));
                sum += std::max(0.0, way.y) / kSteps;
            }
            EXPECT_NEAR(capCosine(cosine, sineSquared) * kPi * sineSquared,
                        sum * capSolidAngle(sineSquared), 1e-5)
                << cosine << " " << sineSquared;
        }
    EXPECT_DOUBLE_EQ(capCosine(0.3, 0), 0.3);
    EXPECT_EQ(capCosine(-0.3, 0), 0);
}

TEST(Lamp, LightsByItsClosedForm) {
    // A point: I cos / d^2.
    EXPECT_NEAR(lit(pointAt({1, 2, 0})), 2 * (2 / std::sqrt(5.0)) / 5, 1e-6);
    EXPECT_EQ(lit(pointAt({1, -2, 0})), 0);
    // A disc of radius r overhead fills a cone of sine r / sqrt(d^2 + r^2).
    EXPECT_NEAR(lit(pointAt({0, 2, 0}, 1)), 2 / 5.0, 1e-6);
    // Suns: E cos, whatever their angle while all of it is above the horizon.
    for (const double angle : {0.0, 0.01, 0.5})
        EXPECT_NEAR(lit(sunOf({1, -2, 0}, angle)), 2 * 2 / std::sqrt(5.0), 1e-6);
    // Of the disc of a sun at the horizon: E (a - sin a cos a) / (pi sin^2 a), a half its angle.
    const double sine = std::sin(0.1);
    EXPECT_NEAR(lit(sunOf({1, 0, 0}, 0.2)), 2 * (0.1 - sine * std::cos(0.1)) / (kPi * sine * sine),
                1e-6);
}

TEST(Spot, FallsOffBetweenItsAngles) {
    const auto at = [](double angle, bool smooth) {
        const Receiver place{Vec3f(Vec3d(std::tan(angle), 0, 0)), Vec3f(0, 1, 0)};
        const double distance2 = 1 / (std::cos(angle) * std::cos(angle));
        return lit(spotAt({0, 1, 0}, smooth), place) * distance2 / (2 * std::cos(angle));
    };
    for (const bool smooth : {false, true}) {
        EXPECT_NEAR(at(0.1, smooth), 1, 1e-5);
        EXPECT_NEAR(at(0.19, smooth), 1, 1e-5);
        EXPECT_EQ(at(0.51, smooth), 0);
    }
    const double x = (std::cos(0.4) - std::cos(0.5)) / (std::cos(0.2) - std::cos(0.5));
    EXPECT_NEAR(at(0.4, false), x * x, 1e-5);
    EXPECT_NEAR(at(0.4, true), x * x * (3 - 2 * x), 1e-5);
    Lamp flat = spotAt({0, 1, 0}, true);
    flat.cone->isFlat = true;
    const Receiver aside{Vec3f(Vec3d(std::tan(0.15), 0, 0)), Vec3f(0, 1, 0)};
    EXPECT_NEAR(lit(flat, aside) / lit(spotAt({0, 1, 0}, true), aside), std::cos(0.15), 1e-5);
}

TEST(AreaLamp, LightsByItsClosedForm) {
    // Overhead, by the view factor of a disc: L pi R^2 / (d^2 + R^2); its strength is L pi R^2.
    EXPECT_NEAR(lit(areaAt(Lamp::Form::ellipse, {0, 2, 0}, 2, 2)), 2 / 5.0, 1e-3);
    // Of a rectangle, four times that over a corner. [Howell, C-11]
    const double a = 0.5, b = 0.25, ra = std::sqrt(1 + a * a), rb = std::sqrt(1 + b * b);
    const double corner = 0.5 * (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb));
    EXPECT_NEAR(lit(areaAt(Lamp::Form::rectangle, {0, 2, 0}, 2, 1)), 4 * corner * 2 / 2, 1e-5);
    // On one side.
    EXPECT_EQ(
        lit(areaAt(Lamp::Form::rectangle, {0, -2, 0}, 2, 1), {Vec3f(0, 0, 0), Vec3f(0, -1, 0)}), 0);
    Lamp flat = areaAt(Lamp::Form::rectangle, {0, 2, 0}, 2, 0);
    EXPECT_EQ(lit(flat), 0);
}

/// Lamps that a place sees as a cap, and areas; whole, and cut by the horizon.
std::vector<Lamp> extended() {
    std::vector<Lamp> lamps{pointAt({0.5, 1, 0}, 0.4), pointAt({0.5, 0.1, 0}, 0.4),
                            sunOf({1, -1, 0.2}, 0.6), sunOf({1, -0.1, 0.2}, 2.5),
                            areaAt(Lamp::Form::ellipse, {0.3, 0.5, 0.1}, 1, 0.5)};
    lamps.push_back(spotAt({0.2, 1, 0}, true));
    lamps.back().radius = 0.2;
    return lamps;
}

// What is drawn adds up to the irradiance, and rays meet what was drawn with the same density.
TEST(Lamp, IsDrawnAsItShines) {
    for (const Lamp& lamp : extended()) {
        const TriangleMesh mesh = meshOf({lamp});
        const Emitters emitters = emittersOfLamps(mesh);
        std::mt19937_64 generator(3);
        std::uniform_real_distribution<double> uniform;
        constexpr int kSamples = 40000;
        double sum = 0;
        for (int i = 0; i < kSamples; ++i) {
            double u = uniform(generator);
            const Emitters::Choice choice = emitters.choose(0, kFloor, u);
            const EmitterPart& part = emitters.parts()[choice.part];
            const EmitterPoint point =
                samplePoint(part, kFloor, uniform(generator), uniform(generator));
            ASSERT_GT(point.density, 0);
            const float cosine = point.direction.dot(kFloor.normal);
            const Rgb radiance = emitters.radianceAt(part, point);
            if (cosine > 0)
                sum += static_cast<double>(radiance.y * cosine / (point.density * choice.chance));
            const auto met = meetLamp(part, kFloor, point.direction);
            if (!met) continue;  // by rounding, at its edge
            EXPECT_NEAR(met->density / point.density, 1, 1e-3);
            EXPECT_NEAR(met->radiance.y / radiance.y, 1, 1e-3);
            if (std::isfinite(met->distance)) {
                EXPECT_NEAR(met->distance / point.position.length(), 1, 1e-3);
            }
        }
        EXPECT_NEAR(sum / kSamples / lit(lamp), 1, 0.02) << static_cast<int>(lamp.form);
    }
}

/// p-value that directions of a cap fall into rings and sectors of one solid angle.
double capPValue(double sineSquared, const std::function<double(double)>& bend) {
    constexpr int kSamples = 400000;
    constexpr std::size_t kRings = 8, kSectors = 8;
    const Vec3d axis = Vec3d(0.3, -0.5, 0.8).normalized();
    Vec3d s, t;
    tangentFrame(axis, s, t);
    std::mt19937_64 generator(5);
    std::uniform_real_distribution<double> uniform;
    std::vector<double> observed(kRings * kSectors);
    const double all = capSolidAngle(sineSquared);
    for (int i = 0; i < kSamples; ++i) {
        const double u = bend(uniform(generator));
        const Vec3d way = sampleCap(axis, sineSquared, u, uniform(generator));
        EXPECT_TRUE(isInCap(axis, sineSquared * (1 + 1e-12), way));
        const double ring = capSolidAngle(axis.cross(way).length2()) / all;
        const double sector = std::atan2(way.dot(t), way.dot(s)) / (2 * kPi) + 0.5;
        const auto cell = [](double x, std::size_t count) {
            return std::min(count - 1, static_cast<std::size_t>(x * static_cast<double>(count)));
        };
        observed[cell(ring, kRings) * kSectors + cell(sector, kSectors)] += 1;
    }
    const std::vector<double> expected(observed.size(),
                                       kSamples / static_cast<double>(observed.size()));
    return test::chiSquaredPValue(observed, expected);
}

TEST(SampleCap, IsUniformInSolidAngle) {
    for (const double sineSquared : {1e-10, 0.3, 1.0})
        EXPECT_GT(capPValue(sineSquared, [](double u) { return u; }), test::significance(3));
}

// Control: the test above must see a 5 % tilt.
TEST(SampleCap, SeesATilt) {
    for (const double sineSquared : {1e-10, 0.3, 1.0})
        EXPECT_LT(capPValue(sineSquared, [](double u) { return u * (0.95 + 0.05 * u); }),
                  test::significance(3));
}

/// A thousand lamps of several forms, all over a hall.
TriangleMesh hall() {
    std::vector<Lamp> lamps;
    std::mt19937_64 generator(7);
    std::uniform_real_distribution<double> uniform;
    for (int i = 0; i < 1000; ++i) {
        const Vec3d place(40 * uniform(generator) - 20, 2 + uniform(generator),
                          40 * uniform(generator) - 20);
        if (i % 10 == 0)
            lamps.push_back(spotAt(place, i % 20 == 0));
        else
            lamps.push_back(pointAt(place, i % 2 == 0 ? 0.05 : 0));
    }
    lamps.push_back(sunOf({0, -1, 0.1}, 0));
    lamps.push_back(sunOf({1, -1, 0.1}, 0.1));
    lamps.push_back(areaAt(Lamp::Form::ellipse, {0, 3, 0}, 1, 1));
    return meshOf(lamps);
}

TEST(Lamps, AreFewEmittersWhereTheyAreMany) {
    const TriangleMesh mesh = hall();
    const Emitters emitters = emittersOfLamps(mesh);
    EXPECT_EQ(emitters.size(), kMostEmitters);
    for (const Vec3f& place : {Vec3f(0, 0, 0), Vec3f(3, 0, 7), Vec3f(-30, 0, 5)}) {
        const Receiver at{place, Vec3f(0, 1, 0)};
        double sum = 0, exact = 0;
        for (std::size_t e = 0; e < emitters.size(); ++e)
            sum += static_cast<double>(emitters.irradiance(e, at).irradiance.y);
        for (const EmitterPart& part : emitters.parts())
            exact += static_cast<double>(irradianceBy(part, at).irradiance.y);
        EXPECT_NEAR(sum / exact, 1, 0.02);
        // Whatever lights the place may be chosen.
        for (std::size_t i = 0; i < emitters.parts().size(); ++i) {
            if (irradianceBy(emitters.parts()[i], at).weight > 0) {
                EXPECT_GT(emitters.chanceOf(i, at), 0) << i;
            }
        }
    }
}

TEST(Lamps, AreMetAsEachByItself) {
    const TriangleMesh mesh = hall();
    const Emitters emitters = emittersOfLamps(mesh);
    std::mt19937_64 generator(9);
    std::uniform_real_distribution<double> uniform;
    const Receiver at{Vec3f(1, 0, 2), Vec3f(0, 1, 0)};
    std::size_t all = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3f way(sampleCap(Vec3d(0, 1, 0), 0.99, uniform(generator), uniform(generator)));
        std::vector<Emitters::Met> met;
        emitters.meetLamps(at, way, met);
        std::size_t count = 0;
        for (const EmitterPart& part : emitters.parts())
            count += meetLamp(part, at, way).has_value() ? 1 : 0;
        EXPECT_EQ(met.size(), count);
        all += count;
    }
    EXPECT_GT(all, 100u);
}

TEST(Lamps, KeepTheirShapesWhateverTheyEmit) {
    TriangleMesh mesh = meshOf({pointAt({0, 1, 0}, 0.1), sunOf({0, -1, 0}, 0.1)});
    const Emitters before = emittersOfLamps(mesh);
    ASSERT_EQ(before.size(), 2u);
    mesh.lamps[0].gain = Rgb(0, 0, 0);
    mesh.lamps[1].strength = Rgb(7, 0, 1);
    const Emitters after = emittersOfLamps(mesh);
    ASSERT_EQ(after.size(), 2u);
    for (std::size_t e = 0; e < 2; ++e) EXPECT_EQ(after.shapeOf(e), before.shapeOf(e));
    EXPECT_EQ(after.irradiance(0, kFloor).weight, 0);
    mesh.lamps[0].radius = 0.2;
    mesh.lamps[1].direction = Vec3d(0.6, -0.8, 0);
    const Emitters moved = emittersOfLamps(mesh);
    for (std::size_t e = 0; e < 2; ++e) EXPECT_NE(moved.shapeOf(e), before.shapeOf(e));
    mesh.lamps[0].strength = Rgb(0, 0, 0);
    EXPECT_EQ(emittersOfLamps(mesh).size(), 1u);
}

}  // namespace
}  // namespace shadowcache
