// The pilot calibrates wrong counts; budgets keep their mean and limits; the fit across the
// horizon.

#include "render/regions/calibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/predict/horizon.h"
#include "render/regions/sample_budget.h"

namespace shadowcache {
namespace {

/// The visibility `v` of a region of posterior `a`, corrected.
float corrected(const Calibration& calibration, float a, float v) {
    const Calibration::Calibrated c = calibration.apply(a);
    return c.slope * v + c.offset;
}

TEST(Calibration, IsTheCountsOwnBeforeAnyRay) {
    const Calibration untested;
    for (const float a : {1e-5f, 0.01f, 0.3f, 0.5f, 0.6f, 0.99f, 0.9999f}) {
        EXPECT_FLOAT_EQ(untested.apply(a).posterior, a);
        EXPECT_EQ(untested.apply(a).slope, 1.0f);
        EXPECT_EQ(untested.apply(a).offset, 0.0f);
    }
}

// Counts of any kind, whatever the rays found: a posterior outside (0, 1) would lose regions.
TEST(Calibration, StaysBetweenZeroAndOne) {
    for (const bool visible : {false, true}) {
        Calibration tested;
        for (int k = 0; k < 20; ++k) {
            const float uncertainty = 1.01f * std::ldexp(0.5f, -k);
            for (int i = 0; i < 3000; ++i) {
                tested.add(std::min(uncertainty, 1.0f), visible);
                tested.add(1 - std::min(uncertainty, 1.0f), visible);
            }
            for (int i = 0; i < 30; ++i) tested.add(std::min(1.47f * uncertainty, 1.0f), visible);
        }
        tested.update();
        for (int k = 0; k <= 4096; ++k) {
            const float a = static_cast<float>(k) / 4096;
            const Calibration::Calibrated calibrated = tested.apply(a);
            EXPECT_GT(calibrated.posterior, 0.0f) << a;
            EXPECT_LT(calibrated.posterior, 1.0f) << a;
        }
    }
}

TEST(Calibration, FindsCountsThatAreWrongAndLeavesRightOnesAlone) {
    Calibration wrong, correct;
    for (int i = 0; i < 4000; ++i) {
        wrong.add(0.999f, i % 2 == 0);
        correct.add(0.999f, i % 1000 != 0);
    }
    wrong.update();
    correct.update();
    EXPECT_NEAR(wrong.apply(0.999f).posterior, 0.5f, 0.01f);
    EXPECT_NEAR(corrected(wrong, 0.999f, 0.999f), 0.5f, 0.01f);
    EXPECT_NEAR(correct.apply(0.999f).posterior, 0.999f, 1e-4f);
    EXPECT_EQ(corrected(correct, 0.999f, 0.999f), 0.999f);
}

// In proportion to what the counts have, so that no place of a bin gains or loses more than there
// is.
TEST(Calibration, CorrectsWithinTheRangeOfVisibility) {
    Calibration tooBright, tooDark;
    for (int i = 0; i < 4000; ++i) {
        for (const float a : {0.3f, 0.9f}) {
            tooBright.add(a, i % 5 == 0);
            tooDark.add(a, i % 50 != 0);
        }
    }
    tooBright.update();
    tooDark.update();
    EXPECT_NEAR(corrected(tooBright, 0.9f, 0.9f), 0.2f, 0.01f);
    EXPECT_NEAR(corrected(tooDark, 0.3f, 0.3f), 0.98f, 0.01f);
    for (const float a : {0.3f, 0.9f})
        for (int k = 0; k <= 8; ++k) {
            const float v = static_cast<float>(k) / 8;
            EXPECT_LE(corrected(tooBright, a, v), v);
            EXPECT_GE(corrected(tooBright, a, v), 0.0f);
            EXPECT_GE(corrected(tooDark, a, v), v);
            EXPECT_LE(corrected(tooDark, a, v), 1.0f);
        }
}

// A dark room: what most of the rays do not find is not predicted where few rays went either. Where
// most rays find what they should, bins of few rays are left alone.
TEST(Calibration, BinsOfFewRaysAreWorthWhatAllAre) {
    Calibration dark, lit;
    for (int i = 0; i < 4000; ++i) {
        dark.add(0.3f, false);
        lit.add(0.3f, i % 10 < 3);
    }
    for (int i = 0; i < 3; ++i)
        for (Calibration* room : {&dark, &lit}) room->add(0.06f, false);
    dark.update();
    lit.update();
    EXPECT_LT(corrected(dark, 0.3f, 1.0f), 1e-3f);
    EXPECT_LT(corrected(dark, 0.06f, 1.0f), 0.01f);
    EXPECT_LT(corrected(dark, 0.9f, 1.0f), 0.01f) << "no ray at all";
    EXPECT_EQ(corrected(lit, 0.06f, 1.0f), 1.0f);
}

// One of three rays that finds light by chance does not make counts credible that thousands of
// others refute; hundreds that find it do.
TEST(Calibration, OneVisibleRayProvesNothingInADarkRoom) {
    Calibration dark;
    for (int i = 0; i < 20000; ++i) dark.add(0.3f, false);
    Calibration darkWithAWindow = dark;
    for (int i = 0; i < 3; ++i) dark.add(0.06f, i == 0);
    for (int i = 0; i < 300; ++i) darkWithAWindow.add(0.9f, i % 10 != 0);
    dark.update();
    darkWithAWindow.update();
    EXPECT_LT(corrected(dark, 0.06f, 1.0f), 0.01f);
    EXPECT_GT(corrected(darkWithAWindow, 0.9f, 1.0f), 0.85f);
    EXPECT_LT(corrected(darkWithAWindow, 0.3f, 1.0f), 0.01f);
}

// The quadratic is a projection: its error has no part of degree 0, 1 or 2, and the moments hold.
TEST(HorizonFit, IsTheProjectionOfTheClampedCosine) {
    for (const float radius : {0.02f, 0.35f})
        for (const float height : {-0.9f * radius, -0.2f * radius, 0.0f, 0.7f * radius}) {
            const HorizonFit fit(height, radius);
            double error[3] = {0, 0, 0}, cosine2 = 0, fit2 = 0;
            constexpr int kNodes = 20000;
            for (int i = 0; i < kNodes; ++i) {
                const double t = 2 * (i + 0.5) / kNodes - 1;
                const double x = static_cast<double>(height) + static_cast<double>(radius) * t;
                const auto q = static_cast<double>(fit(static_cast<float>(x)));
                for (int k = 0; k < 3; ++k)
                    error[k] += (std::max(0.0, x) - q) * std::pow(t, k) / kNodes;
                cosine2 += std::pow(std::max(0.0, x), 2) / kNodes;
                fit2 += q * q / kNodes;
            }
            const auto scale = static_cast<double>(radius);
            for (const double e : error) EXPECT_NEAR(e / scale, 0, 2e-6);
            EXPECT_NEAR(cosine2 / scale / scale,
                        static_cast<double>(fit.cosineMoment) / scale / scale, 2e-6);
            EXPECT_NEAR(fit2 / scale / scale, static_cast<double>(fit.fitMoment) / scale / scale,
                        2e-6);
        }
}

TEST(SampleBudget, KeepsTheMeanAndFollowsTheNoise) {
    std::vector<PredictedNoise> places;
    places.reserve(400);
    for (int i = 0; i < 400; ++i) places.push_back({0.001 * i, 1});
    const SampleBudget budget(places, 64);
    double sum = 0;
    for (const PredictedNoise& place : places) sum += budget.samplesOf(place);
    EXPECT_NEAR(sum / 400, 64, 0.5);
    EXPECT_NEAR(budget.samplesOf(places[0]), 16, 1e-9);
    EXPECT_GT(budget.samplesOf(places[399]), 2 * budget.samplesOf(places[150]));
    EXPECT_NEAR(budget.samplesOf({1e9, 1}), 1024, 1e-9);
}

// One sample each, and still some places get more than others.
TEST(SampleBudget, SharesOutFractionsOfASample) {
    std::vector<PredictedNoise> places;
    places.reserve(400);
    for (int i = 0; i < 400; ++i) places.push_back({0.001 * i, 1});
    const SampleBudget budget(places, 1);
    EXPECT_NEAR(budget.samplesOf(places[0]), 0.25, 1e-9);
    EXPECT_GT(budget.samplesOf(places[399]), 1);
}

}  // namespace
}  // namespace shadowcache
