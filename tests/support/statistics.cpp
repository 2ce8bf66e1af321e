#include "tests/support/statistics.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cassert>
#include <cmath>
#include <vector>

namespace shadowcache::test {
namespace {

struct Moments {
    double count, mean, variance;
};

Moments moments(std::span<const double> samples) {
    const auto count = static_cast<double>(samples.size());
    double sum = 0.0;
    for (const double x : samples) sum += x;
    const double mean = sum / count;
    double squares = 0.0;
    for (const double x : samples) squares += (x - mean) * (x - mean);
    return {count, mean, squares / (count - 1.0)};
}

/// Two-sided p-value of a difference of means; what is not finite is a failure, not a pass.
double tTestPValue(double difference, double squaredError, double degreesOfFreedom) {
    if (!std::isfinite(difference) || !std::isfinite(squaredError)) return 0.0;
    if (squaredError == 0.0) return difference == 0.0 ? 1.0 : 0.0;
    const boost::math::students_t distribution(degreesOfFreedom);
    const double t = std::abs(difference) / std::sqrt(squaredError);
    return 2.0 * boost::math::cdf(boost::math::complement(distribution, t));
}

}  // namespace

double significance(std::size_t comparisons) {
    constexpr double kSuiteLevel = 1e-4;
    const double ofOneTest = -std::expm1(std::log1p(-kSuiteLevel) / kStatisticalTests);
    return ofOneTest / static_cast<double>(comparisons);
}

double chiSquaredTail(double statistic, double degreesOfFreedom) {
    return boost::math::gamma_q(0.5 * degreesOfFreedom, 0.5 * std::max(0.0, statistic));
}

double chiSquaredPValue(std::span<const double> observed, std::span<const double> expected) {
    assert(observed.size() == expected.size());
    constexpr double kLeastExpected = 5.0;
    struct Cell {
        double expected, observed;
    };
    std::vector<Cell> cells;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        if (!std::isfinite(observed[i]) || (expected[i] <= 0.0 && observed[i] > 0.0)) return 0.0;
        if (expected[i] > 0.0) cells.push_back({expected[i], observed[i]});
    }
    std::sort(cells.begin(), cells.end(),
              [](const Cell& a, const Cell& b) { return a.expected > b.expected; });
    // The smallest cells come last: each joins its neighbour until none is too small.
    while (cells.size() > 1 && cells.back().expected < kLeastExpected) {
        const Cell small = cells.back();
        cells.pop_back();
        cells.back().expected += small.expected;
        cells.back().observed += small.observed;
    }
    double statistic = 0.0;
    for (const Cell& cell : cells)
        statistic +=
            (cell.observed - cell.expected) * (cell.observed - cell.expected) / cell.expected;
    return cells.size() > 1 ? chiSquaredTail(statistic, static_cast<double>(cells.size() - 1))
                            : 1.0;
}

double meanPValue(std::span<const double> samples, double mean) {
    assert(samples.size() >= 20);
    const Moments m = moments(samples);
    return tTestPValue(m.mean - mean, m.variance / m.count, m.count - 1.0);
}

double sameMeanPValue(std::span<const double> a, std::span<const double> b) {
    assert(a.size() >= 2 && b.size() >= 2);
    const Moments ma = moments(a);
    const Moments mb = moments(b);
    const double ea = ma.variance / ma.count;
    const double eb = mb.variance / mb.count;
    // Degrees of freedom of the sum of the two variances. [Welch 1947]
    const double freedom =
        (ea + eb) * (ea + eb) / (ea * ea / (ma.count - 1.0) + eb * eb / (mb.count - 1.0));
    return tTestPValue(ma.mean - mb.mean, ea + eb, freedom);
}

}  // namespace shadowcache::test
