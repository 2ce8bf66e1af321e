#pragma once

#include "render/estimators/estimator.h"

namespace shadowcache {

struct PaperOptions {
    int triangles = 5000;  ///< M, 20 .. 100000
    int minLevel = 3;      ///< least level of the triangulation
    int maxLevel = 6;      ///< highest level, 0 .. 7
    double alpha = 0.7;    ///< mixing weight of the cache's prediction, [0, 1)
    int threshold = 3;     ///< fewest pooled rays of a region that count
    double beta = 0;       ///< share of samples uniform over the hemisphere, [0, 1]
    int cacheLevel = 7;    ///< finest level of the counts it uses, 0 .. 7
};

/// @throws Error naming the option, the value and the range allowed
void validate(const PaperOptions& options);

std::unique_ptr<Estimator> makePaper(const EstimatorContext& context, const PaperOptions& options);

}  // namespace shadowcache
