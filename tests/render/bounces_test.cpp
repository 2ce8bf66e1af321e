// Light that bounces against closed forms.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "common/base/hash.h"
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
        BounceOptions options{.most = bounces};
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
                points.back().seed = key;
            }
            std::vector<BounceReceiver> receivers;
            receivers.reserve(points.size());
            for (const ShadingPoint& point : points)
                receivers.push_back({&point, Rgb(albedo), true, nullptr});
            std::vector<BouncedLight> found(points.size());
            BounceCounts counts;
            light.gather(receivers, found, counts);
            double sum = 0;
            for (const BouncedLight& l : found) sum += static_cast<double>(l.irradiance.x);
            means.push_back(sum / (kPi * count));
        }
        return means;
    }

    TriangleMesh mesh_;
    std::optional<Scene> scene_;
};

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
        const std::vector<double> found = estimates(c.albedo, c.most, 130, 1000);
        const double truth = Sphere::truth(static_cast<double>(c.albedo), c.most);
        EXPECT_GT(test::meanPValue(found, truth), level);
        EXPECT_LT(test::meanPValue(found, 1.02 * truth), level) << "2 % more is accepted";
    }
}

TEST_F(Sphere, ReflectsNothingWhereItIsBlack) {
    for (const double mean : estimates(0, kUnlimitedBounces, 2, 100)) EXPECT_EQ(mean, 0);
}

}  // namespace
}  // namespace shadowcache
