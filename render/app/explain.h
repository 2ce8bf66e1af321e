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

/// Text that says which estimator works, on what, what noise and what time to expect. Renders a
/// thumbnail to know.
std::string explain(const FrameRequest& frame, const Forecast& forecast);

}  // namespace shadowcache
