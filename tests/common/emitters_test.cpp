// Emitters: irradiance by triangles in closed form, clipped to the horizon; points and triangles
// are drawn with the density that is claimed; groups, sides and shapes.

#include "common/emitters/emitters.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "common/emitters/lit_triangle.h"
#include "common/math/angle.h"
#include "tests/support/statistics.h"

namespace shadowcache {
namespace {

using Corners = std::array<Vec3d, 3>;

const Vec3d kUp(0, 1, 0);

/// Adds a triangle of a material that emits.
void add(TriangleMesh& mesh, const Corners& corners, int material = 0) {
    const auto first = static_cast<int>(mesh.positions.size());
    for (const Vec3d& corner : corners) mesh.positions.emplace_back(corner);
    mesh.triangles.emplace_back(first, first + 1, first + 2);
    mesh.parts.push_back({static_cast<std::uint32_t>(mesh.triangles.size() - 1), 1, material});
}

Material shining(const Rgb& radiance, bool twoSided = true) {
    Material material;
    material.finish.emission = radiance;
    material.doubleSided = twoSided;
    return material;
}

Emitters emittersOf(const TriangleMesh& mesh) {
    const TriangleMesh* const meshes[] = {&mesh};
    return Emitters(meshes);
}

/// What the sum of the parts of a triangle that n^2 splits make reflects.
double summed(const Corners& t, const Vec3d& n, int splits) {
    const Vec3d side1 = (t[1] - t[0]) / splits, side2 = (t[2] - t[0]) / splits;
    const Vec3d normal = side1.cross(side2) * 0.5;
    double sum = 0;
    for (int i = 0; i < splits; ++i)
        for (int k = 0; k < 2 * (splits - i) - 1; ++k) {
            const double shift = k % 2 == 0 ? 1.0 / 3 : 2.0 / 3;
            const int column = k / 2;
            const Vec3d way = t[0] + side1 * (i + shift) + side2 * (column + shift);
            const double squared = way.length2();
            sum += std::max(0.0, n.dot(way)) * std::abs(normal.dot(way)) / (squared * squared);
        }
    return sum;
}

/// View factor of a rectangle over one of its corners, times pi; a and b are its sides over its
/// height. [Howell, C-11]
double overhead(double a, double b) {
    const double ra = std::sqrt(1 + a * a), rb = std::sqrt(1 + b * b);
    return 0.5 * (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb));
}

TEST(AngleOf, IsThatOfTheLibrary) {
    for (double y : {0.0, 1e-150, 1e-12, 1e-3, 0.1, 0.4, 0.415, 1.0, 2.5, 1e8})
        for (double x : {-1e8, -3.0, -1.0, -0.4, -1e-9, 0.0, 1e-9, 0.4, 1.0, 3.0, 1e8})
            EXPECT_NEAR(angleOf(y, x), std::atan2(y, x), 2e-12 * std::atan2(y, x)) << y << ' ' << x;
}

TEST(CosineIntegral, HasClosedForms) {
    for (const auto& [a, b] : {std::pair(1.0, 1.0), {0.001, 0.002}, {30.0, 0.5}}) {
        const Corners one{Vec3d(0, 1, 0), Vec3d(a, 1, 0), Vec3d(a, 1, b)};
        const Corners two{Vec3d(0, 1, 0), Vec3d(0, 1, b), Vec3d(a, 1, b)};
        const double both = cosineIntegral(aboveHorizon(one, kUp), kUp) +
                            cosineIntegral(aboveHorizon(two, kUp), kUp);
        EXPECT_NEAR(both / overhead(a, b), 1, 1e-9);
    }
    // All around, a ceiling fills the hemisphere.
    double ceiling = 0;
    for (int k = 0; k < 4; ++k) {
        const auto corner = [](int i) {
            return Vec3d(i % 4 < 2 ? 1e7 : -1e7, 1, (i + 1) % 4 < 2 ? 1e7 : -1e7);
        };
        ceiling +=
            cosineIntegral(aboveHorizon({Vec3d(0, 1, 0), corner(k), corner(k + 1)}, kUp), kUp);
    }
    EXPECT_NEAR(ceiling, kPi, 1e-5);
}

TEST(CosineIntegral, IsClippedToTheHorizon) {
    const Corners wall{Vec3d(1, -1, 0.2), Vec3d(1.2, 1.5, 0), Vec3d(0.7, 0.4, 1.5)};
    const double exact = summed(wall, kUp, 2000);
    EXPECT_NEAR(cosineIntegral(aboveHorizon(wall, kUp), kUp) / exact, 1, 1e-4);
    const Corners turned{wall[2], wall[1], wall[0]};
    EXPECT_DOUBLE_EQ(cosineIntegral(aboveHorizon(turned, kUp), kUp),
                     cosineIntegral(aboveHorizon(wall, kUp), kUp));
    EXPECT_EQ(aboveHorizon({Vec3d(1, -1, 0), Vec3d(2, -1, 0), Vec3d(1, -2, 1)}, kUp).corners, 0);
    // Two corners above leave four.
    EXPECT_EQ(aboveHorizon(wall, kUp).corners, 4);
}

/// A triangle near a place at 0 that looks up, far from it, and one that the horizon cuts.
EmitterPart lampAt(const Corners& corners) {
    TriangleMesh mesh;
    mesh.materials.push_back(shining(Rgb(1)));
    add(mesh, corners);
    return emittersOf(mesh).parts()[0];
}
const Corners kNear{Vec3d(-1, 0.5, -1), Vec3d(1, 0.7, -0.5), Vec3d(0.2, 0.9, 1)};
const Corners kFar{Vec3d(4, 6, -1), Vec3d(4.5, 6, -0.5), Vec3d(4.2, 6.4, 0)};
const Corners kCut{Vec3d(0.5, -1, 0.2), Vec3d(0.8, 1.5, 0), Vec3d(0.4, 0.4, 1.5)};

/// p-value that samples fall into the parts of a triangle, cut along its sides, as their density
/// says: each counts as the solid angle of the part that is above the horizon.
double densityPValue(const Corners& corners, const std::function<double(double)>& bend) {
    constexpr int kSamples = 200000, kSide = 6;
    const EmitterPart t = lampAt(corners);
    const Receiver at{Vec3f(0), Vec3f(kUp)};
    std::vector<double> observed(kSide * kSide), expected(kSide * kSide);
    // Expected counts by a fine grid of points, each with the density that is claimed.
    constexpr int kFine = 240;
    double all = 0;
    for (int i = 0; i < kFine; ++i)
        for (int k = 0; k < kFine - i; ++k) {
            const double u = (i + 1.0 / 3) / kFine, v = (k + 1.0 / 3) / kFine;
            const Vec3d way =
                corners[0] + (corners[1] - corners[0]) * u + (corners[2] - corners[0]) * v;
            const double front = std::abs(Vec3d(t.normal).dot(way)), squared = way.length2();
            const bool near =
                densityAt(t, at, Vec3f(way)) > 0 && (Vec3f(t.centre)).length() < 3 * t.size;
            if (near && way.dot(kUp) <= 0) continue;
            const double share = static_cast<double>(densityAt(t, at, Vec3f(way))) * front /
                                 (squared * std::sqrt(squared));
            const auto cell =
                static_cast<std::size_t>(u * kSide) * kSide + static_cast<std::size_t>(v * kSide);
            expected[cell] += share;
            all += share;
        }
    for (double& count : expected) count *= kSamples / all;
    std::mt19937_64 generator(3);
    std::uniform_real_distribution<double> uniform;
    for (int i = 0; i < kSamples; ++i) {
        const double u = bend(uniform(generator));
        const EmitterPoint point = samplePoint(t, at, u, uniform(generator));
        EXPECT_NEAR(point.density / densityAt(t, at, point.position), 1, 1e-3);
        const auto row =
            std::min<std::size_t>(kSide - 1, static_cast<std::size_t>(point.u * kSide));
        const auto column =
            std::min<std::size_t>(kSide - 1, static_cast<std::size_t>(point.v * kSide));
        observed[row * kSide + column] += 1;
    }
    // Cells along the sloped side are half outside: the grid knows their area to a per cent only.
    std::vector<double> inside, wanted;
    double rest = kSamples, restWanted = kSamples;
    for (std::size_t i = 0; i < observed.size(); ++i) {
        if (i / kSide + i % kSide + 2 > kSide) continue;
        inside.push_back(observed[i]);
        wanted.push_back(expected[i]);
        rest -= observed[i];
        restWanted -= expected[i];
    }
    inside.push_back(rest);
    wanted.push_back(restWanted);
    return test::chiSquaredPValue(inside, wanted);
}

TEST(EmitterPoint, HasItsDensity) {
    for (const Corners& corners : {kNear, kFar})
        EXPECT_GT(densityPValue(corners, [](double u) { return u; }), test::significance(2));
}

// Control: the test above must see a 5 % tilt.
TEST(EmitterPoint, SeesATilt) {
    for (const Corners& corners : {kNear, kFar})
        EXPECT_LT(densityPValue(corners, [](double u) { return u * (0.95 + 0.05 * u); }),
                  test::significance(2));
}

TEST(EmitterPoint, ChoosesSolidAnglesThatAddUp) {
    for (const Corners& corners : {kNear, kCut}) {
        const EmitterPart t = lampAt(corners);
        const Receiver at{Vec3f(0), Vec3f(kUp)};
        std::mt19937_64 generator(5);
        std::uniform_real_distribution<double> uniform;
        double sum = 0;
        constexpr int kSamples = 20000;
        for (int i = 0; i < kSamples; ++i) {
            const EmitterPoint point = samplePoint(t, at, uniform(generator), uniform(generator));
            ASSERT_GT(point.density, 0);
            EXPECT_GE(point.direction.dot(at.normal), -1e-6f);
            sum += static_cast<double>(point.direction.dot(at.normal) / point.density) / kSamples;
        }
        EXPECT_NEAR(sum / cosineIntegral(aboveHorizon(corners, kUp), kUp), 1, 0.02);
    }
}

/// How far `irradiance` of thin and other triangles is from its closed form, at most, where they
/// are about as near as may be for the far one's.
template <class Irradiance>
double worstFar(const Irradiance& irradiance) {
    std::mt19937_64 generator(3);
    std::normal_distribution<double> normal;
    const auto vector = [&] {
        return Vec3d(normal(generator), normal(generator), normal(generator));
    };
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        const double width = i % 2 == 0 ? 1 : 0.02;
        Corners corners{vector(), vector(), vector()};
        for (Vec3d& corner : corners) corner.x *= width;
        const EmitterPart unplaced = lampAt(corners);
        const Vec3d way = vector().normalized() * (5.01 * static_cast<double>(unplaced.radius));
        const Vec3d up = vector().normalized();
        if (way.dot(up) <= static_cast<double>(unplaced.radius)) continue;
        for (Vec3d& corner : corners) corner += way - Vec3d(unplaced.centre);
        EmitterPart t = lampAt(corners);
        t.twoSided = true;
        const double exact = cosineIntegral(aboveHorizon(corners, up), up);
        worst = std::max(
            worst, std::abs(static_cast<double>(irradiance(t, {Vec3f(0), Vec3f(up)})) / exact - 1));
    }
    return worst;
}

TEST(EmitterPart, LightsFromAfarWithinTwoPerCent) {
    EXPECT_LT(worstFar([](const EmitterPart& t, const Receiver& at) {
                  return irradianceBy(t, at).irradiance.y / t.radiance.y;
              }),
              0.02);
}

// Control: the test above must see that its centre alone is not enough.
TEST(EmitterPart, OfItsCentreAloneDoesNot) {
    EXPECT_GT(worstFar([](const EmitterPart& t, const Receiver& at) {
                  const float squared = t.centre.length2();
                  return t.area * at.normal.dot(t.centre) * std::abs(t.normal.dot(t.centre)) /
                         (squared * squared);
              }),
              0.02);
}

/// Small triangles all over a sphere around (0, 3, 0), turned anyhow.
TriangleMesh sign(int count, bool twoSided) {
    TriangleMesh mesh;
    mesh.materials.push_back(shining(Rgb(1, 2, 3), twoSided));
    std::mt19937_64 generator(7);
    std::normal_distribution<double> normal;
    const auto direction = [&] {
        return Vec3d(normal(generator), normal(generator), normal(generator)).normalized();
    };
    for (int i = 0; i < count; ++i) {
        const Vec3d middle = Vec3d(0, 3, 0) + direction() * 2.0;
        add(mesh, {middle, middle + direction() * 0.05, middle + direction() * 0.05});
    }
    return mesh;
}

TEST(Emitters, HaveARoughWeightWhereverTheyShine) {
    std::mt19937_64 generator(5);
    std::normal_distribution<double> normal;
    const auto vector = [&] {
        return Vec3d(normal(generator), normal(generator), normal(generator));
    };
    for (const bool twoSided : {false, true}) {
        const TriangleMesh mesh = sign(600, twoSided);
        const Emitters emitters = emittersOf(mesh);
        int far = 0, shines = 0;
        for (int i = 0; i < 4000; ++i) {
            const Receiver at{Vec3f(Vec3d(0, 3, 0) + vector() * 4.0), Vec3f(vector().normalized())};
            for (std::size_t e = 0; e < emitters.size(); ++e) {
                const float exact = emitters.irradiance(e, at).weight;
                const float rough = emitters.roughWeight(e, at);
                if (exact > 0) {
                    ++shines;
                    ASSERT_GT(rough, 0.0f) << i << ' ' << e;
                }
            }
            for (std::size_t k = 0; k < emitters.parts().size(); k += 37) {
                const EmitterPart& part = emitters.parts()[k];
                const float exact = irradianceBy(part, at).weight;
                const float rough = roughWeightBy(part, at);
                if (exact > 0) {
                    ASSERT_GT(rough, 0.0f) << i << ' ' << k;
                }
                const Vec3f way = part.centre - at.position;
                if (!(exact > 0) || way.length() < 4 * part.radius ||
                    at.normal.dot(way) < part.radius)
                    continue;
                ++far;
                ASSERT_NEAR(rough / exact, 1, 0.4) << i << ' ' << k;
            }
        }
        EXPECT_GT(far, 10000);
        EXPECT_GT(shines, 10000);
    }
}

/// p-value that triangles are chosen as often as chanceOf() says.
double choicePValue(const std::function<double(double)>& bend) {
    const TriangleMesh mesh = sign(400, false);
    const Emitters emitters = emittersOf(mesh);
    const Receiver at{Vec3f(0.5f, 0, 0.2f), Vec3f(kUp)};
    std::mt19937_64 generator(11);
    std::uniform_real_distribution<double> uniform;
    double least = 1;
    std::size_t tests = 0;
    for (std::size_t e = 0; e < emitters.size(); e += 8, ++tests) {
        const std::size_t count = emitters.partsOf(e).size();
        const auto first =
            static_cast<std::size_t>(emitters.partsOf(e).data() - emitters.parts().data());
        std::vector<double> observed(count + 1), expected(count + 1);
        constexpr int kSamples = 20000;
        expected[count] = kSamples;
        for (std::size_t i = 0; i < count; ++i) {
            expected[i] = kSamples * static_cast<double>(emitters.chanceOf(first + i, at));
            expected[count] -= expected[i];
        }
        for (int i = 0; i < kSamples; ++i) {
            double u = bend(uniform(generator));
            const Emitters::Choice choice = emitters.choose(e, at, u);
            observed[choice.chance > 0 ? choice.part - first : count] += 1;
            if (choice.chance > 0) {
                EXPECT_FLOAT_EQ(choice.chance, emitters.chanceOf(choice.part, at));
            }
        }
        // What rounding leaves of a chance is none.
        if (expected[count] < 1e-3)
            observed[count - 1] += std::exchange(observed[count], 0), expected[count] = 0;
        least = std::min(least, test::chiSquaredPValue(observed, expected));
    }
    return least * static_cast<double>(tests);
}

TEST(Emitters, ChooseByTheirChances) {
    EXPECT_GT(choicePValue([](double u) { return u; }), test::significance(1));
}

// Control: the test above must see a 10 % tilt.
TEST(Emitters, SeeATilt) {
    EXPECT_LT(choicePValue([](double u) { return u * (0.9 + 0.1 * u); }), test::significance(1));
}

TEST(Emitters, AddUpToTheirTriangles) {
    for (const bool twoSided : {false, true}) {
        const TriangleMesh mesh = sign(3000, twoSided);
        const Emitters emitters = emittersOf(mesh);
        EXPECT_EQ(emitters.size(), kMostEmitters);
        ASSERT_EQ(emitters.parts().size(), 3000u);
        for (const Vec3f& place : {Vec3f(0, 0, 0), Vec3f(0, 2, 0.3f), Vec3f(30, -20, 0)}) {
            const Receiver at{place, Vec3f(kUp)};
            Vec3d sum(0), exact(0);
            for (std::size_t e = 0; e < emitters.size(); ++e)
                sum += Vec3d(emitters.irradiance(e, at).irradiance);
            for (const EmitterPart& t : emitters.parts()) {
                const float front = t.normal.dot(place - t.centre);
                if (front < 0 && !twoSided) continue;
                const Vec3d p(place);
                exact += Vec3d(t.radiance) * cosineIntegral(aboveHorizon({Vec3d(t.corner[0]) - p,
                                                                          Vec3d(t.corner[1]) - p,
                                                                          Vec3d(t.corner[2]) - p},
                                                                         kUp),
                                                            kUp);
            }
            EXPECT_NEAR(sum.y / exact.y, 1, 0.2) << place.x;
            EXPECT_NEAR(sum.z / sum.x, 3, 1e-4);
        }
    }
}

TEST(Emitters, AreGroupsOfConnectedTriangles) {
    TriangleMesh mesh;
    mesh.materials = {shining(Rgb(1)), shining(Rgb(2)), Material{}};
    add(mesh, {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(0, 1, 0)});
    add(mesh, {Vec3d(1, 0, 0), Vec3d(1, 1, 0), Vec3d(0, 1, 0)});     // the same quad
    add(mesh, {Vec3d(1, 1, 0), Vec3d(2, 1, 0), Vec3d(1, 2, 0)}, 1);  // touches it, emits otherwise
    add(mesh, {Vec3d(5, 0, 0), Vec3d(6, 0, 0), Vec3d(5, 1, 0)});     // elsewhere
    add(mesh, {Vec3d(8, 0, 0), Vec3d(9, 0, 0), Vec3d(8, 1, 0)}, 2);  // does not emit
    add(mesh, {Vec3d(8, 0, 0), Vec3d(9, 0, 0), Vec3d(9, 0, 0)});     // has no area
    const Emitters emitters = emittersOf(mesh);
    ASSERT_EQ(emitters.size(), 3u);
    std::size_t pairs = 0;
    for (std::size_t e = 0; e < 3; ++e) pairs += emitters.partsOf(e).size() == 2 ? 1 : 0;
    EXPECT_EQ(pairs, 1u);
    EXPECT_EQ(emitters.find(0, 4), -1);
    EXPECT_EQ(emitters.find(0, 5), -1);
    ASSERT_GE(emitters.find(0, 3), 0);
    EXPECT_EQ(emitters.parts()[static_cast<std::size_t>(emitters.find(0, 3))].corner[0],
              Vec3f(5, 0, 0));
}

TEST(Emitters, KeepTheirShapesWhateverTheyEmit) {
    TriangleMesh mesh = sign(20, true);
    const Emitters before = emittersOf(mesh);
    mesh.materials[0].finish.emission = Rgb(5, 0, 0);
    const Emitters brighter = emittersOf(mesh);
    for (std::size_t e = 0; e < before.size(); ++e)
        EXPECT_EQ(before.shapeOf(e), brighter.shapeOf(e));
    for (Vec3f& p : mesh.positions) p.x += 0.5f;
    EXPECT_NE(emittersOf(mesh).shapeOf(0), before.shapeOf(0));
    mesh.materials[0].finish.emission = Rgb(0);
    EXPECT_TRUE(emittersOf(mesh).empty());
}

// A bake counts nothing where a lamp does not shine: one that shines elsewhere is another.
TEST(Emitters, HaveAnotherShapeWhereTheyShineElsewhere) {
    const auto shapeOf = [](const Lamp& lamp) {
        TriangleMesh mesh;
        mesh.lamps = {lamp};
        return emittersOf(mesh).shapeOf(0);
    };
    Lamp area;
    area.form = Lamp::Form::rectangle;
    area.strength = Rgb(1);
    area.halfWidth = Vec3d(1, 0, 0);
    area.halfHeight = Vec3d(0, 0, 1);
    area.direction = Vec3d(0, -1, 0);
    area.spread = 0.4;
    Lamp spot;
    spot.strength = Rgb(1);
    spot.direction = Vec3d(0, -1, 0);
    spot.cone = LampCone{.cosInner = 0.9, .cosOuter = 0.8};
    for (const Lamp& lamp : {area, spot}) {
        Lamp other = lamp;
        other.gain = Rgb(2);
        other.strength = Rgb(3);
        EXPECT_EQ(shapeOf(other), shapeOf(lamp));
        other = lamp;
        other.direction = Vec3d(0, 1, 0);
        EXPECT_NE(shapeOf(other), shapeOf(lamp));
    }
    Lamp other = area;
    for (const double spread : {0.5, kPi}) {
        other.spread = spread;
        EXPECT_NE(shapeOf(other), shapeOf(area));
    }
    other = spot;
    other.cone->cosOuter = 0.7;
    EXPECT_NE(shapeOf(other), shapeOf(spot));
    other.cone.reset();
    EXPECT_NE(shapeOf(other), shapeOf(spot));
}

TEST(Emitters, EmitFromTheSidesThatTheirFileSays) {
    const Corners overhead{Vec3d(-1, 1, -1), Vec3d(1, 1, -1), Vec3d(0, 1, 1)};
    for (const bool twoSided : {false, true}) {
        TriangleMesh mesh;
        mesh.materials.push_back(shining(Rgb(1), twoSided));
        add(mesh, overhead);
        const Emitters emitters = emittersOf(mesh);
        const auto light = [&](const Vec3f& from, const Vec3f& normal) {
            return emitters.irradiance(0, {from, normal}).weight;
        };
        // By its winding, the triangle looks down.
        EXPECT_GT(light(Vec3f(0), Vec3f(kUp)), 0);
        EXPECT_EQ(light(Vec3f(0, 2, 0), -Vec3f(kUp)) > 0, twoSided);
        EXPECT_EQ(light(Vec3f(0), -Vec3f(kUp)), 0);
    }
}

}  // namespace
}  // namespace shadowcache
