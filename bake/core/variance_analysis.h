#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "bake/core/visibility_counter.h"

namespace shadowcache {

/// Two-way analysis of variance of the rays into some cells: how much of the variance of their
/// visibility the direction explains, and how much the origin. Rays of one shot share an origin
/// (VisibilityCounter::add).
struct VarianceAnalysis {
    double mean = 0;        ///< visible share of the rays, a
    double directions = 0;  ///< variance between the cells, of a (1 - a) in all; may be negative
    double origins = 0;     ///< variance between the origins; may be negative

    /// By how much the deviation of a ray's visibility falls once the cells are known one by one:
    /// sqrt(a (1 - a)) - sqrt(a (1 - a) - directions), 0 .. 0.5.
    double gain() const;
};

/// Analyses the rays into `cells`, of which `pairs` share an origin.
///
/// Unbiased for any numbers of rays: each variance is the mean product of two visibilities over the
/// pairs of rays that share a cell or an origin, less that over the pairs that share neither. For
/// equal numbers these are the estimators of the classical analysis of variance. All is 0 if there
/// is no pair of a kind. [Searle, Casella & McCulloch 1992, Variance Components, Sec. 5.2]
VarianceAnalysis analyseVariance(std::span<const Count> cells, const OriginPairs& pairs);

}  // namespace shadowcache
