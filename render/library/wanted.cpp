#include "render/library/wanted.h"

#include <fmt/core.h>

#include <string_view>

#include "common/base/error.h"
#include "common/base/take_text.h"
#include "render/frame/aov_channels.h"

namespace shadowcache {

Chosen choose(const Wanted& wanted, bool hasCache) {
    const EstimatorEntry& estimator =
        findEstimator(wanted.estimator.value_or(hasCache ? "cache" : "mis"));
    Chosen chosen{estimator, wanted.options};
    RenderOptions& options = chosen.options;
    chooseRays(wanted.rays, estimator, options);
    options.bounces = wanted.bounces.value_or(kStandardBounces);
    for (const std::string& aov : wanted.aovs) {
        if (needsInsight(aov) && !estimator.needsCache)
            throw Error(fmt::format("--aov {}: requires --estimator cache", aov));
        options.insight = options.insight || needsInsight(aov);
    }
    validate(options);
    requireFit(estimator, hasCache, options);
    return chosen;
}

int parseBounces(const std::string& text) {
    if (text == "unlimited") return kUnlimitedBounces;
    int bounces = 0;
    std::string_view rest = text;
    if (!takeNumber(rest, bounces) || !rest.empty() || bounces < 0 || bounces > kMostBounces)
        throw Error(fmt::format("--bounces {}: expected a number from 0 to {}, or unlimited", text,
                                kMostBounces));
    return bounces;
}

}  // namespace shadowcache
