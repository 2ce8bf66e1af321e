#pragma once

#include <cstddef>
#include <span>

namespace shadowcache::test {

/// Statistical tests in the suite, at most; `statistical_tests` counts them.
inline constexpr int kStatisticalTests = 200;

/// Level of each of `comparisons` (> 0) in one test, from the suite's budget of 1e-4 false alarms:
/// a test passes while its p-values are above it, and those of its control must come out below. One
/// call for each group of comparisons: two calls are counted as two tests.
double significance(std::size_t comparisons);

/// Upper tail of the chi-squared distribution.
double chiSquaredTail(double statistic, double degreesOfFreedom);

/// p-value of Pearson's test that counts `observed` follow `expected` (same total); cells expected
/// below 5 are pooled; a count where none may fall gives 0.
double chiSquaredPValue(std::span<const double> observed, std::span<const double> expected);

/// Two-sided p-value that `samples` (independent, >= 20) have the mean `mean` (t-test).
double meanPValue(std::span<const double> samples, double mean);

/// Two-sided p-value that the two sets of independent samples have one mean (Welch's t-test).
double sameMeanPValue(std::span<const double> a, std::span<const double> b);

}  // namespace shadowcache::test
