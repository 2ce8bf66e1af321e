// The default path on a ball, where clusters of points have many normals.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "render/frame/integrator.h"
#include "render/frame/pilot.h"
#include "tests/support/lit_floor.h"
#include "tests/support/statistics.h"

namespace shadowcache {
namespace {

using test::CacheKind;
using test::cacheKinds;
using test::Effort;
using test::effort;

/// A ball alone under a map: nothing hides the sky. Points that are lit together have normals of
/// their own.
class LitBall {
public:
    /// @param truth  irradiance of a normal; below 0 where pixels shall not count
    LitBall(const Image& map, std::function<double(const Vec3d&)> truth, bool adaptive = true)
        : truth_(std::move(truth)) {
        TriangleMesh mesh;
        test::addSphere(mesh, {0, 0, 0}, 1, 24);
        world_.emplace(std::move(mesh), map, BakeOptions{.spacing = 0.5, .adaptive = adaptive});
    }

    /// Relative errors of films, one for each seed.
    std::vector<double> errors(const CacheKind& kind, const Effort& chosen, int count,
                               bool withPilot) const {
        BakeResult told = world_->baked;
        kind.change(told);
        const test::TestCache cache(told);
        EstimatorContext context = world_->context();
        context.cache = &cache.cache();
        const auto estimator = findEstimator("cache").make(context);
        FrameRequest frame{*estimator, camera_, 1, effort(chosen.cameraRays, chosen.samples)};
        RenderOptions& options = frame.options;
        RenderStats stats;
        options.seed = 1000;
        if (withPilot) frame.plan = planFrame(frame, stats);
        std::vector<double> ratios;
        for (options.seed = 1; static_cast<int>(ratios.size()) < count; ++options.seed) {
            double found = 0, truth = 0;
            for (const Pixel& pixel : render(frame, stats).pixels) {
                // Pixels at the edge of the ball are only partly of it.
                const double seen = static_cast<double>(pixel.albedo.y / options.plain.albedo.y);
                const double wanted = seen > 0 ? truth_(Vec3d(pixel.normal) / seen) * seen : -1;
                if (wanted < 0) continue;
                found += static_cast<double>(pixel.irradiance.y);
                truth += wanted;
            }
            ratios.push_back(found / truth - 1);
        }
        return ratios;
    }

private:
    std::function<double(const Vec3d&)> truth_;
    const Camera camera_ = lookAt({2, 1.5, 1}, {0, 0, 0}, {0, 1, 0}, 0.5);
    std::optional<test::World> world_;
};

class DefaultPathOnABall : public testing::TestWithParam<std::size_t> {
protected:
    /// With its control: `wrong` more is rejected.
    static void expectTruth(const std::vector<double>& errors, double wrong, double level) {
        EXPECT_GT(test::meanPValue(errors, 0), level);
        EXPECT_LT(test::meanPValue(errors, -wrong), level);
    }

    /// Under a gradient the irradiance is linear in the normal. Baked once for all tests.
    static const LitBall& ball() {
        static const Vec3d slope{0.5, 0.3, -0.4};
        static const LitBall ball(test::gradientMap(512, 256, slope), [](const Vec3d& normal) {
            return kPi + 2 * kPi / 3 * slope.dot(normal);
        });
        return ball;
    }
};

INSTANTIATE_TEST_SUITE_P(Caches, DefaultPathOnABall, testing::Values<std::size_t>(0, 1),
                         [](const auto& test) { return cacheKinds()[test.param].name; });

TEST_P(DefaultPathOnABall, MeetsTheClosedForm) {
    const double level = test::significance(5);
    for (const Effort& e : {Effort{1, 1}, {1, 16}, {4, 4}, {16, 1}, {16, 4}}) {
        SCOPED_TRACE(fmt::format("{} x {}", e.cameraRays, e.samples));
        expectTruth(ball().errors(cacheKinds()[GetParam()], e, 60, true), 0.01, level);
    }
}

class DefaultPathTerminator : public testing::TestWithParam<bool> {};

INSTANTIATE_TEST_SUITE_P(Correct, DefaultPathTerminator, testing::Bool(), [](const auto& test) {
    return std::string(test.param ? "Calibrated" : "Uncalibrated");
});

// A sun stands low over points whose cluster's middle does not see it; fine counts make its region
// small. With its control: 3 % more.
TEST_P(DefaultPathTerminator, MeetsTheClosedForm) {
    constexpr int kColumns = 512, kRows = 256;
    const auto [x, y] = test::texelAt(kColumns, kRows, Vec3d(-0.3, 0.8, -0.6).normalized());
    const Vec3d moment = test::texelMoment(kColumns, kRows, x, y) * 1e4;
    static const LitBall ball(  // of both instances
        test::oneTexelMap(kColumns, kRows, x, y, Rgb(1e4f, 1e4f, 1e4f)),
        [moment](const Vec3d& normal) {
            const double cosine = normal.dot(moment) / moment.length();
            return cosine > 0.01 && cosine < 0.2 ? normal.dot(moment) : -1;
        },
        false);
    const auto errors = ball.errors(cacheKinds()[0], {1, 4}, 60, GetParam());
    EXPECT_GT(test::meanPValue(errors, 0), test::significance(1));
    EXPECT_LT(test::meanPValue(errors, -0.03), test::significance(1));
}

/// Without a pilot nothing corrects wrong counts: all of the light that they deny comes from
/// samples, whose numbers and densities count in full.
struct Uncalibrated {
    CacheKind cache;
    double wrong;  ///< share of the light that is told apart
};

/// Of the last, nothing is so far off that neighbours reuse it.
std::vector<Uncalibrated> uncalibrated() {
    return {{cacheKinds()[1], 0.015},
            {cacheKinds()[3], 0.015},
            {{"ThreeQuarters",
              [](BakeResult& b) {
                  test::fillCounts(b, [](std::size_t) { return std::array{153, 200}; });
              }},
             0.004}};
}

class DefaultPathUncalibrated : public DefaultPathOnABall {};

INSTANTIATE_TEST_SUITE_P(Caches, DefaultPathUncalibrated, testing::Values<std::size_t>(0, 1, 2),
                         [](const auto& test) { return uncalibrated()[test.param].cache.name; });

TEST_P(DefaultPathUncalibrated, MeetsTheClosedForm) {
    const auto [cache, wrong] = uncalibrated()[GetParam()];
    const double level = test::significance(3);
    for (const Effort& e : {Effort{1, 1}, {4, 4}, {16, 1}}) {
        SCOPED_TRACE(fmt::format("{} x {}", e.cameraRays, e.samples));
        const int count = std::max(60, 240 / (e.cameraRays * e.samples));
        expectTruth(ball().errors(cache, e, count, false), wrong, level);
    }
}

}  // namespace
}  // namespace shadowcache
