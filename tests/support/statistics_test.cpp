// P-values are uniform under the hypothesis and not beside it; tails match tables.

#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

namespace shadowcache::test {
namespace {

using Generator = std::mt19937_64;

/// Kolmogorov-Smirnov distance of 2000 p-values from the uniform distribution, one p-value a seed.
double distanceFromUniform(const std::function<double(Generator&)>& pValue) {
    std::vector<double> p;
    for (unsigned seed = 0; seed < 2000; ++seed) {
        Generator generator(seed);
        p.push_back(pValue(generator));
    }
    std::sort(p.begin(), p.end());
    double distance = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const auto rank = static_cast<double>(i);
        const auto count = static_cast<double>(p.size());
        distance = std::max({distance, p[i] - rank / count, (rank + 1.0) / count - p[i]});
    }
    return distance;
}

/// Distance that 2000 uniform numbers exceed in 1 of 100 cases.
constexpr double kLimit = 0.0364;

/// p-value of counts of 40 cells of unlike size against `assumed`, drawn with the weights `drawn`.
double countsPValue(Generator& generator, double tilt) {
    std::vector<double> assumed, drawn;
    double assumedSum = 0.0;
    for (int i = 0; i < 40; ++i) {
        assumed.push_back(1.0 + i % 4);
        drawn.push_back(assumed.back() * (1.0 + tilt * i));
        assumedSum += assumed.back();
    }
    constexpr int kSamples = 2000;
    std::discrete_distribution<std::size_t> distribution(drawn.begin(), drawn.end());
    std::vector<double> observed(assumed.size());
    for (int i = 0; i < kSamples; ++i) observed[distribution(generator)] += 1.0;
    for (double& value : assumed) value *= kSamples / assumedSum;
    return chiSquaredPValue(observed, assumed);
}

std::vector<double> normalSamples(Generator& generator, std::size_t count, double mean,
                                  double deviation) {
    std::normal_distribution<double> distribution(mean, deviation);
    std::vector<double> samples(count);
    for (double& x : samples) x = distribution(generator);
    return samples;
}

TEST(Significance, SharesTheBudgetOfTheSuite) {
    EXPECT_NEAR(1.0 - std::pow(1.0 - significance(1), kStatisticalTests), 1e-4, 1e-9);
    EXPECT_EQ(significance(7), significance(1) / 7);
}

TEST(ChiSquared, TailMatchesTables) {
    EXPECT_NEAR(chiSquaredTail(3.841458820694124, 1), 0.05, 1e-12);
    EXPECT_NEAR(chiSquaredTail(18.307038053275146, 10), 0.05, 1e-12);
    EXPECT_NEAR(chiSquaredTail(149.44925277903886, 100), 0.001, 1e-12);
    EXPECT_EQ(chiSquaredTail(0, 7), 1.0);
}

TEST(ChiSquared, PValuesAreUniform) {
    EXPECT_LT(distanceFromUniform([](Generator& g) { return countsPValue(g, 0.0); }), kLimit);
}

TEST(ChiSquared, PValuesOfAWrongHypothesisAreNot) {
    EXPECT_GT(distanceFromUniform([](Generator& g) { return countsPValue(g, 0.002); }), kLimit);
}

TEST(ChiSquared, RefusesCountsWhereNoneMayFall) {
    const std::vector<double> expected{50, 50, 0};
    EXPECT_EQ(chiSquaredPValue(std::vector<double>{50, 49, 1}, expected), 0.0);
    EXPECT_EQ(chiSquaredPValue(std::vector<double>{50, 50, 0}, expected), 1.0);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(chiSquaredPValue(std::vector<double>{nan, 50, 0}, expected), 0.0);
}

// One cell expected at 1e-3 that holds a single count would alone add 1000 to the statistic.
TEST(ChiSquared, PoolsSmallCells) {
    const std::vector<double> expected{100, 100, 4.999, 0.001};
    EXPECT_GT(chiSquaredPValue(std::vector<double>{98, 101, 5, 1}, expected), 0.5);
}

TEST(Mean, PValuesAreUniform) {
    EXPECT_LT(distanceFromUniform(
                  [](Generator& g) { return meanPValue(normalSamples(g, 20, 3.0, 2.0), 3.0); }),
              kLimit);
}

TEST(Mean, PValuesOfAWrongHypothesisAreNot) {
    EXPECT_GT(distanceFromUniform(
                  [](Generator& g) { return meanPValue(normalSamples(g, 20, 3.0, 2.0), 3.2); }),
              kLimit);
}

TEST(Mean, ConstantAndBrokenSamplesAreDecided) {
    std::vector<double> samples(20, 0.5);
    EXPECT_EQ(meanPValue(samples, 0.5), 1.0);
    EXPECT_EQ(meanPValue(samples, 0.6), 0.0);
    samples[3] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(meanPValue(samples, 0.5), 0.0);
}

TEST(SameMean, PValuesAreUniformForUnlikeVariances) {
    EXPECT_LT(distanceFromUniform([](Generator& g) {
                  return sameMeanPValue(normalSamples(g, 30, 1.0, 1.0),
                                        normalSamples(g, 50, 1.0, 4.0));
              }),
              kLimit);
}

TEST(SameMean, PValuesOfAWrongHypothesisAreNot) {
    EXPECT_GT(distanceFromUniform([](Generator& g) {
                  return sameMeanPValue(normalSamples(g, 30, 1.0, 1.0),
                                        normalSamples(g, 50, 1.3, 4.0));
              }),
              kLimit);
}

}  // namespace
}  // namespace shadowcache::test
