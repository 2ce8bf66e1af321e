// Light that bounces against closed forms.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/hash.h"
#include "common/cache/transport.h"
#include "render/bounces/bounce_light.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

/// Direct light that is known.
class KnownLight final : public PointEstimator {
public:
    KnownLight(const EstimatorContext& context, float irradiance)
        : PointEstimator(context), irradiance_(irradiance) {}

private:
    Rgb prepare(const ShadingPoint&, const SampleSlice&, Workspace& workspace) const override {
        workspace.samples.endGroup();
        return Rgb(irradiance_);
    }

    const float irradiance_;
};

// A sphere seen from inside with a hole at its top: every place of it receives the same light from
// each part of its wall, so that all bounces have a closed form.
class Sphere : public testing::Test {
protected:
    static constexpr int kRings = 96, kOpenRings = 16;

    Sphere() {
        TriangleMesh all;
        test::addSphere(all, {0, 0, 0}, 1, kRings);
        for (const Vec3i& t : all.triangles) {
            const Vec3f centre = (all.positions[static_cast<std::size_t>(t.x)] +
                                  all.positions[static_cast<std::size_t>(t.y)] +
                                  all.positions[static_cast<std::size_t>(t.z)]) /
                                 3.0f;
            if (static_cast<double>(centre.y) < std::cos(kOpenRings * kPi / kRings))
                test::addTriangle(mesh_, all.positions[static_cast<std::size_t>(t.x)],
                                  all.positions[static_cast<std::size_t>(t.y)],
                                  all.positions[static_cast<std::size_t>(t.z)]);
        }
        scene_.emplace(mesh_);
    }

    /// Share of the sphere that is open.
    static double hole() { return (1 - std::cos(kOpenRings * kPi / kRings)) / 2; }

    /// Irradiance of every place from other places, over pi, under a sky of radiance 1.
    static double truth(double albedo, int bounces) {
        const double ratio = albedo * (1 - hole());
        if (bounces == kUnlimitedBounces) return hole() * ratio / (1 - ratio);
        double sum = 0, term = hole();
        for (int b = 0; b < bounces; ++b) sum += term *= ratio;
        return sum;
    }

    /// Mean irradiance of `count` places from other places, over pi, for each of some seeds.
    std::vector<double> estimates(float albedo, int bounces, int seeds, int count) const {
        const Environment environment = test::environmentOf(test::constantMap(Rgb(1.0f)));
        const KnownLight direct({*scene_, environment, nullptr}, static_cast<float>(kPi * hole()));
        return estimates(direct, albedo, bounces, seeds, count);
    }

    /// The same with direct light by an estimator.
    std::vector<double> estimates(const Estimator& direct, float albedo, int bounces, int seeds,
                                  int count, float trust = 1, PathPilot* pilot = nullptr) const {
        BounceOptions options{.most = bounces, .trust = trust};
        options.plain.albedo = Rgb(albedo);
        const BounceLight light(direct, nullptr, options);
        std::vector<double> means;
        for (int seed = 1; seed <= seeds; ++seed) {
            std::vector<ShadingPoint> points;
            points.reserve(static_cast<std::size_t>(count));
            for (int i = 0; i < count; ++i) {
                const std::uint64_t key =
                    hashWords(static_cast<std::uint64_t>(seed), static_cast<std::uint64_t>(i));
                const double y = 0.6 * toUnit(hashWords(key, 1)) - 0.8,
                             phi = 2 * kPi * toUnit(hashWords(key, 2));
                const double r = std::sqrt(1 - y * y);
                points.push_back(test::pointAlong(
                    *scene_, {0, 0, 0}, Vec3f(Vec3d(r * std::cos(phi), y, r * std::sin(phi)))));
                points.back().slot.seed = key;
            }
            std::vector<BounceReceiver> receivers;
            receivers.reserve(points.size());
            for (const ShadingPoint& point : points)
                receivers.push_back({&point, Rgb(albedo), true, nullptr});
            std::vector<BouncedLight> found(points.size());
            BounceCounts counts;
            light.gather(
                receivers, found, counts, [] {}, pilot);
            double sum = 0;
            for (const BouncedLight& l : found) sum += static_cast<double>(l.irradiance.x);
            means.push_back(sum / (kPi * count));
        }
        return means;
    }

    TriangleMesh mesh_;
    std::optional<Scene> scene_;
};

/// Deviation of the mean of 150 places, as a share of it, that noise of single samples may have.
constexpr double kMostSpread = 0.12;

struct Bounces {
    float albedo;
    int most;
};

TEST_F(Sphere, HasTheLightOfTheSeries) {
    const Bounces cases[] = {{0.5f, 1},
                             {0.8f, 2},
                             {0.99f, 4},
                             {0.8f, 16},
                             {0.5f, kUnlimitedBounces},
                             {0.9f, kUnlimitedBounces}};
    const double level = test::significance(std::size(cases));
    for (const Bounces& c : cases) {
        SCOPED_TRACE(fmt::format("{:f}, {}", c.albedo, c.most));
        const std::vector<double> found = estimates(c.albedo, c.most, 100, 1000);
        const double truth = Sphere::truth(static_cast<double>(c.albedo), c.most);
        EXPECT_GT(test::meanPValue(found, truth), level);
        EXPECT_LT(test::meanPValue(found, 1.02 * truth), level) << "2 % more is accepted";
    }
}

/// p-value that the estimates scatter around the truth with a deviation of `share` of it, or less.
double steadinessPValue(std::span<const double> means, double truth, double share) {
    double squares = 0;
    for (const double mean : means) squares += std::pow((mean / truth - 1) / share, 2);
    return test::chiSquaredTail(squares, static_cast<double>(means.size()));
}

// Many bounces between bright walls make the whole picture uncertain, not its pixels: paths that
// correct a prediction must not become rarer and heavier with each bounce.
TEST_F(Sphere, IsSteadyWhereItIsPredicted) {
    const test::World world(mesh_, test::constantMap(Rgb(1.0f)), {.spacing = 0.2});
    const ItemTable items(world.cache.cache());
    const Transport transport = readTransport(world.cache.cache(), items).value();
    const Bounces cases[] = {{0.5f, 4},   {0.5f, kUnlimitedBounces}, {0.9f, 4},
                             {0.9f, 64},  {0.9f, kUnlimitedBounces}, {0.99f, 4},
                             {0.99f, 64}, {0.99f, kUnlimitedBounces}};
    const double level = test::significance(2 * std::size(cases));
    for (const Bounces& c : cases) {
        SCOPED_TRACE(fmt::format("{:f}, {}", c.albedo, c.most));
        const std::vector<ItemLook> looks(items.size(), ItemLook{Rgb(c.albedo), Rgb(0.0f)});
        const BounceSolve solve(world.cache.cache(), items, transport, world.environment, looks,
                                c.most);
        EstimatorContext context = world.context();
        context.solve = &solve;
        const auto estimator = findEstimator("cache").make(context, {});
        const std::vector<double> found = estimates(*estimator, c.albedo, c.most, 32, 150);
        const double truth = Sphere::truth(static_cast<double>(c.albedo), c.most);
        EXPECT_GT(test::meanPValue(found, truth), level);
        EXPECT_LT(test::meanPValue(found, 1.25 * truth), level) << "25 % more is accepted";
        // With a chance of 3/5 whatever the albedo, 64 bounces have 45 % and 430 %.
        EXPECT_GT(steadinessPValue(found, truth, kMostSpread), level);
        EXPECT_LT(steadinessPValue(found, truth, kMostSpread / 5), level) << "any would do";
    }
}

// Of what is predicted, whatever it is, any part leaves the mean as it is; paths tell how much of
// it is true.
TEST_F(Sphere, IsRightWhateverIsPredicted) {
    const test::World world(mesh_, test::constantMap(Rgb(1.0f)), {.spacing = 0.2});
    const ItemTable items(world.cache.cache());
    const Transport transport = readTransport(world.cache.cache(), items).value();
    constexpr int kMost = 3;
    constexpr float kAlbedo = 0.5f;
    const double truth = Sphere::truth(static_cast<double>(kAlbedo), kMost);
    const struct {
        float predicted;  // albedo
        float trust;
    } cases[] = {{kAlbedo, 1}, {kAlbedo, 0.4f}, {3, 1}, {3, 0.4f}, {3, 0}};
    const double level = test::significance(std::size(cases));
    for (const auto& c : cases) {
        SCOPED_TRACE(fmt::format("{:f}, {:f}", c.predicted, c.trust));
        const std::vector<ItemLook> looks(items.size(), ItemLook{Rgb(c.predicted), Rgb(0.0f)});
        const BounceSolve solve(world.cache.cache(), items, transport, world.environment, looks,
                                kMost);
        EstimatorContext context = world.context();
        context.solve = &solve;
        const auto estimator = findEstimator("cache").make(context, {});
        PathPilot pilot;
        const std::vector<double> found =
            estimates(*estimator, kAlbedo, kMost, 32, 500, c.trust, &pilot);
        EXPECT_GT(test::meanPValue(found, truth), level);
        EXPECT_LT(test::meanPValue(found, 1.25 * truth), level) << "25 % more is accepted";
        if (c.trust < 1) continue;
        if (c.predicted == kAlbedo)
            EXPECT_GT(pilot.check.trust(), 0.8f);
        else
            EXPECT_LT(pilot.check.trust(), 0.2f);
    }
}

TEST(PredictionCheck, IsTheFactorOfLeastSquares) {
    PredictionCheck check;
    EXPECT_EQ(check.trust(), 1);
    check.add(2, 1);
    check.add(1, 0);
    EXPECT_FLOAT_EQ(check.trust(), 0.4f);
    check.add(1, 100);
    EXPECT_EQ(check.trust(), 1);
    check.add(1, -200);
    EXPECT_EQ(check.trust(), 0);
}

TEST_F(Sphere, ReflectsNothingWhereItIsBlack) {
    for (const double mean : estimates(0, kUnlimitedBounces, 2, 100)) EXPECT_EQ(mean, 0);
}

}  // namespace
}  // namespace shadowcache
