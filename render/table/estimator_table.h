#pragma once

#include <string>

#include "render/cached/cache_estimator.h"
#include "render/estimators/basic_estimators.h"
#include "render/paper/paper_estimators.h"

namespace shadowcache {

/// Bounces of a picture that is delivered.
inline constexpr int kStandardBounces = 4;

/// The options of all estimators; each reads its own.
struct EstimatorOptions {
    CacheOptions cache;
    PaperOptions paper;
};

/// One line of the table of estimators. All are unbiased, `cache` with at least one sample.
struct EstimatorEntry {
    const char* name;
    const char* summary;
    int minSamples;
    bool needsCache;
    std::unique_ptr<Estimator> (*maker)(const EstimatorContext&, const EstimatorOptions&);
    bool lit = true;  ///< may render sets that shine; else it is of the sky alone, as published

    std::unique_ptr<Estimator> make(const EstimatorContext& context,
                                    const EstimatorOptions& options = {}) const;
};

/// How pictures of `samples` shadow rays a camera ray are biased: "none", or the cause.
std::string biasOf(int samples);

/// Every estimator that `--estimator` offers.
std::span<const EstimatorEntry> estimatorTable();

/// @throws Error naming the estimators there are
const EstimatorEntry& findEstimator(const std::string& name);

}  // namespace shadowcache
