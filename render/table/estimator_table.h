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
    PixelOptions pixel;
    LightsOptions lights;
};

/// @throws Error naming the option, the value and the range allowed
void validate(const EstimatorOptions& options);

/// One line of the table of estimators.
struct EstimatorEntry {
    const char* name;
    const char* summary;
    int minSamples;
    bool needsCache;
    std::unique_ptr<Estimator> (*maker)(const EstimatorContext&, const EstimatorOptions&);
    const char* bias = nullptr;  ///< what its expectation leaves out or gets wrong; null: nothing
    bool inOrder = false;        ///< Estimator::inOrder()

    /// Bounces of its pictures unless others are asked for: those of a picture to deliver, or none
    /// where its direct light is not all that there is, or cannot be asked for at any place.
    int standardBounces() const { return bias || inOrder ? 0 : kStandardBounces; }

    std::unique_ptr<Estimator> make(const EstimatorContext& context,
                                    const EstimatorOptions& options = {}) const {
        return maker(context, options);
    }
};

/// How the estimates of `samples` samples are biased: "none", or the cause.
std::string biasOf(const EstimatorEntry& entry, int samples);

/// Every estimator that `--estimator` offers.
std::span<const EstimatorEntry> estimatorTable();

/// @throws Error naming the estimators there are
const EstimatorEntry& findEstimator(const std::string& name);

}  // namespace shadowcache
