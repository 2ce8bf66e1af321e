#pragma once

#include <string>

#include "render/frame/integrator.h"
#include "render/table/estimator_table.h"

namespace shadowcache {

/// What rendering will take and give, found out on a small picture of the first frame.
struct Forecast {
    const EstimatorEntry& estimator;
    bool chosen;  ///< by --estimator, not by default
    int frames;
    double setupSeconds;  ///< already spent on loading and building
};

/// Text about the job: estimator, inputs, and the noise and time to expect, measured by rendering a
/// thumbnail.
std::string explain(FrameRequest frame, const Forecast& forecast);

}  // namespace shadowcache
