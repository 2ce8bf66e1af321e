// Lamps: irradiance by points, discs, suns, spots and areas in closed form; directions are drawn
// with the density that is claimed, areas with a spread, too, beside numeric integrals; a thousand
// of them are 32 emitters; rays meet those with an extent; those that move change no others.

#include <gtest/gtest.h>

#include <algorithm>
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
    // Blender's has an edge where it has no falloff, and none that is wider than it says.
    for (const double outer : {0.04, 0.5}) {
        Lamp hard = spotAt({0, 1, 0}, true);
        hard.cone->cosInner = hard.cone->cosOuter = std::cos(outer);
        const auto shines = [&](double angle) {
            return lit(hard, {Vec3f(Vec3d(std::tan(angle), 0, 0)), Vec3f(0, 1, 0)}) *
                   std::pow(std::cos(angle), -3) / 2;
        };
        EXPECT_NEAR(shines(0.97 * outer), 1, 1e-5);
        EXPECT_EQ(shines(1.03 * outer), 0);
    }
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

/// An area with a spread, and a place that it lights.
struct SpreadCase {
    Lamp lamp;
    Receiver at;
};

/// Wide and narrow, near and far, from below and from the side, cut by the horizon.
std::vector<SpreadCase> spreadCases() {
    std::vector<SpreadCase> cases;
    const Vec3f tilted(Vec3d(1, 0.5, 0.2).normalized());
    for (const Lamp::Form form : {Lamp::Form::rectangle, Lamp::Form::ellipse})
        for (const double spread : {0.05, 0.6, 2.0, 3.1})
            for (const double height : {0.05, 0.8, 6.0}) {
                Lamp lamp = areaAt(form, {0.1, height, 0.05}, 1, 0.5);
                lamp.spread = spread;
                cases.push_back({lamp, kFloor});
                // As far aside as half of the spread shines.
                const double aside = 0.5 * height * std::tan(0.25 * spread);
                cases.push_back({lamp, {Vec3f(Vec3d(-aside, 0, 0)), tilted}});
            }
    // Narrower than floats tell corners apart.
    for (const Lamp::Form form : {Lamp::Form::rectangle, Lamp::Form::ellipse}) {
        Lamp lamp = areaAt(form, {0.3, 2, 0.1}, 5e-9, 0.5);
        lamp.spread = 0.5;
        cases.push_back({lamp, kFloor});
    }
    return cases;
}

/// What a point of an area with a spread sends to a place, by a radiance of 1 along its axis and by
/// its area. @param way  to it
double sentFrom(const Lamp& lamp, const Receiver& at, const Vec3d& way) {
    const Vec3d w = way.normalized();
    const double cosine = -lamp.direction.dot(w);
    if (cosine <= 0) return 0;
    const double angle = std::acos(std::min(1.0, cosine));
    const double left = 1 - std::tan(angle) / std::tan(0.5 * lamp.spread);
    return std::max(0.0, left) * std::max(0.0, Vec3d(at.normal).dot(w)) * cosine / way.length2();
}

/// Whether points of a part light a place.
bool lights(const Lamp& lamp, const EmitterPart& part, const Receiver& at) {
    constexpr int kSide = 12;
    const Vec3d side1(part.corner[1] - part.corner[0]), side2(part.corner[2] - part.corner[0]);
    const Vec3d way(part.corner[0] - at.position);
    for (int i = 0; i < kSide; ++i)
        for (int k = 0; i + k < kSide; ++k)
            if (sentFrom(lamp, at,
                         way + side1 * ((i + 1.0 / 3) / kSide) + side2 * ((k + 1.0 / 3) / kSide)) >
                0)
                return true;
    return false;
}

bool holds(const EmitterPart& part, const Vec3d& point) {
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d side(part.corner[(i + 1) % 3] - part.corner[i]);
        const Vec3d inwards = Vec3d(part.normal).cross(side);
        if (inwards.dot(Vec3d(part.corner[(i + 2) % 3] - part.corner[i])) *
                inwards.dot(point - Vec3d(part.corner[i])) <
            0)
            return false;
    }
    return true;
}

/// Irradiance in green by an area, by a grid of points of each part.
double byGrid(const Lamp& lamp, const Emitters& emitters, const Receiver& at) {
    constexpr int kSide = 60;
    double sum = 0;
    for (const EmitterPart& part : emitters.parts()) {
        const Vec3d side1(part.corner[1] - part.corner[0]), side2(part.corner[2] - part.corner[0]);
        const Vec3d way(part.corner[0] - at.position);
        for (int i = 0; i < kSide; ++i)
            for (int k = 0; k < 2 * (kSide - i) - 1; ++k) {
                const int column = k / 2;
                const double shift = k % 2 == 0 ? 1.0 / 3 : 2.0 / 3;
                sum += static_cast<double>(part.area * part.radiance.y) *
                       sentFrom(lamp, at,
                                way + side1 * ((i + shift) / kSide) +
                                    side2 * ((column + shift) / kSide));
            }
    }
    return sum / (kSide * kSide);
}

/// The same by rings around the point that is nearest to the place, where they are small.
double byRings(const Lamp& lamp, const Emitters& emitters, const Receiver& at, double front) {
    constexpr int kRings = 300, kSectors = 300;
    const Vec3d place(at.position), foot = place - lamp.direction * front;
    const double most = front * std::tan(0.5 * lamp.spread);
    Vec3d s, t;
    tangentFrame(lamp.direction, s, t);
    double sum = 0;
    for (int i = 0; i < kRings; ++i)
        for (int k = 0; k < kSectors; ++k) {
            const double radius = most * (i + 0.5) / kRings, turn = 2 * kPi * (k + 0.5) / kSectors;
            const Vec3d point = foot + (s * std::cos(turn) + t * std::sin(turn)) * radius;
            const bool isOn = std::ranges::any_of(
                emitters.parts(), [&](const EmitterPart& part) { return holds(part, point); });
            if (isOn) sum += radius * sentFrom(lamp, at, point - place);
        }
    return sum * (most / kRings) * (2 * kPi / kSectors) *
           static_cast<double>(emitters.parts()[0].radiance.y);
}

double integrated(const Lamp& lamp, const Emitters& emitters, const Receiver& at) {
    const double front = lamp.direction.dot(Vec3d(at.position) - lamp.position);
    const bool isSmall = front * std::tan(0.5 * lamp.spread) < 0.3;
    return isSmall ? byRings(lamp, emitters, at, front) : byGrid(lamp, emitters, at);
}

/// Values of samples of an area; each has the radiance that a ray meets there.
std::vector<double> drawn(const Emitters& emitters, const Receiver& at) {
    std::mt19937_64 generator(3);
    std::uniform_real_distribution<double> uniform;
    std::vector<double> values;
    for (int i = 0; i < 40000; ++i) {
        double u = uniform(generator);
        double& value = values.emplace_back(0);
        const Emitters::Choice choice = emitters.choose(0, at, u);
        if (!(choice.chance > 0)) continue;
        const EmitterPart& part = emitters.parts()[choice.part];
        const EmitterPoint point = samplePoint(part, at, uniform(generator), uniform(generator));
        if (!(point.density > 0)) continue;
        const Rgb radiance = emitters.radianceAt(part, point);
        const float cosine = std::max(0.0f, point.direction.dot(at.normal));
        value = static_cast<double>(radiance.y * cosine / (point.density * choice.chance));
        const auto met = meetLamp(part, at, point.direction);
        if (!met) continue;  // by rounding, at its edge
        EXPECT_NEAR(met->radiance.y, radiance.y, 1e-3f * part.radiance.y);
        if (radiance.y > 0) {
            EXPECT_NEAR(met->density / point.density, 1, 1e-2);
        }
    }
    return values;
}

// With its control: 5 % more must be rejected.
TEST(AreaWithASpread, IsDrawnAsItShines) {
    const std::vector<SpreadCase> cases = spreadCases();
    const double level = test::significance(cases.size());
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const auto& [lamp, at] = cases[i];
        const TriangleMesh mesh = meshOf({lamp});
        const Emitters emitters = emittersOfLamps(mesh);
        const double truth = integrated(lamp, emitters, at);
        ASSERT_GT(truth, 0) << i;
        const std::vector<double> values = drawn(emitters, at);
        // A grid tells the truth to half a per cent: less does not count.
        double mean = 0;
        for (const double value : values) mean += value / static_cast<double>(values.size());
        if (std::abs(mean / truth - 1) > 0.005) {
            EXPECT_GT(test::meanPValue(values, truth), level) << i;
        }
        EXPECT_LT(test::meanPValue(values, truth * 1.05), level) << i << ": 5 % more is accepted";
    }
}

TEST(AreaWithASpread, LightsAboutAsItsIntegral) {
    for (const auto& [lamp, at] : spreadCases()) {
        const TriangleMesh mesh = meshOf({lamp});
        const Emitters emitters = emittersOfLamps(mesh);
        EXPECT_NEAR(lit(lamp, at) / integrated(lamp, emitters, at), 1, 0.25)
            << static_cast<int>(lamp.form) << " " << lamp.spread << " " << lamp.position.y;
    }
}

TEST(AreaWithASpread, MayBeChosenWhereverItShines) {
    std::mt19937_64 generator(13);
    std::normal_distribution<double> normal;
    const auto vector = [&] {
        return Vec3d(normal(generator), normal(generator), normal(generator));
    };
    int found = 0;
    for (const double spread : {0.05, 0.6, 2.0, 3.1})
        for (int i = 0; i < 400; ++i) {
            Lamp lamp =
                areaAt(i % 2 == 0 ? Lamp::Form::ellipse : Lamp::Form::rectangle, vector(), 1, 0.3);
            lamp.spread = spread;
            const TriangleMesh mesh = meshOf({lamp});
            const Emitters emitters = emittersOfLamps(mesh);
            const double below = 4 * std::abs(normal(generator));
            const Vec3d aside = vector() * (0.3 + 0.3 * below * std::tan(0.25 * spread));
            const Receiver at{Vec3f(lamp.position + Vec3d(aside.x, -below, aside.z)),
                              Vec3f(vector().normalized())};
            for (std::size_t k = 0; k < emitters.parts().size(); ++k) {
                const EmitterPart& part = emitters.parts()[k];
                if (!lights(lamp, part, at)) continue;
                ++found;
                ASSERT_GT(roughWeightBy(part, at), 0.0f) << spread << ' ' << i << ' ' << k;
                ASSERT_GT(emitters.roughWeight(0, at), 0.0f) << spread << ' ' << i;
                ASSERT_GT(emitters.chanceOf(k, at), 0.0f) << spread << ' ' << i << ' ' << k;
            }
        }
    EXPECT_GT(found, 3000);
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

TEST(Lamps, ThatMoveChangeNoOthers) {
    TriangleMesh mesh = hall();
    const Emitters still = emittersOfLamps(mesh);
    for (int i = 0; i < 3; ++i) {
        mesh.lamps.insert(mesh.lamps.begin() + 5 * i, pointAt({1.5 * i, 1, 0}, 0.1));
        mesh.lamps[static_cast<std::size_t>(5 * i)].moves = true;
    }
    const Emitters all = emittersOfLamps(mesh);
    ASSERT_EQ(all.size(), still.size() + 3);
    for (std::size_t e = 0; e < still.size(); ++e) {
        EXPECT_EQ(all.shapeOf(e), still.shapeOf(e));
        EXPECT_FALSE(all.moves(e));
    }
    for (std::size_t e = still.size(); e < all.size(); ++e) EXPECT_TRUE(all.moves(e));
    // A bake counts none of them.
    const TriangleMesh* const meshes[] = {&mesh};
    EXPECT_EQ(Emitters(meshes, EmitterWeight::shape).parts().size(), still.parts().size());
}

}  // namespace
}  // namespace shadowcache
