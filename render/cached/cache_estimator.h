#pragma once

#include "render/estimators/estimator.h"

namespace shadowcache {

struct CacheOptions {
    bool adaptive = true;  ///< share the frame's samples out by predicted noise
};

/// The cache as a control variate. [docs/estimator.md]
std::unique_ptr<Estimator> makeCacheEstimator(const EstimatorContext& context,
                                              const CacheOptions& options);

}  // namespace shadowcache
