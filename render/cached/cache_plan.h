#pragma once

#include <cmath>
#include <optional>

#include "common/base/tuned.h"
#include "render/cached/heaviness.h"
#include "render/estimators/frame_pilot.h"
#include "render/regions/calibration.h"
#include "render/regions/region_shares.h"
#include "render/regions/sample_budget.h"

namespace shadowcache {

/// How much of the light that is predicted but not sure makes a place bright, whose samples are
/// then not heavy.
inline SHADOWCACHE_TUNED(double, kUnsureShare, 0.4);

/// All that is decided of a frame as a whole before any of its pixels: what a pilot finds, or, as
/// it is made, what holds without one.
struct CachePlan final : EstimatorPlan {
    Calibration calibration;
    std::optional<SampleBudget> budget;  ///< where samples are shared out
    double splitNoise = 0;  ///< of a cell, times samples, below which it stays whole [radiance sr]
    double darkest = 0;     ///< irradiance below which errors count no more [luminance]
    double floor = 1;       ///< irradiance below which errors are absolute [luminance]
    double heavy = kHeavy;  ///< part of a point's brightness from which on samples are reused

    /// How bright places are beside their samples.
    Brightness brightness() const { return {darkest, budget ? kUnsureShare : kUnsureShareUniform}; }
    /// @param luminance, deviation  predicted of the point's irradiance, and of one sample
    PredictedNoise noiseOf(double luminance, double deviation, const BatchSlot& slot) const {
        return {deviation, slot.errorScale > 0 ? static_cast<double>(slot.errorScale)
                                               : std::hypot(luminance, floor)};
    }
    PredictedNoise noiseOf(const Regions& regions, const BatchSlot& slot) const {
        return noiseOf(regions.predictedLuminance, deviationOf(regions), slot);
    }
    /// Samples of a point of so much noise, where `mean` are the mean.
    double samplesOf(const PredictedNoise& noise, int mean) const {
        return budget ? budget->samplesOf(noise) : mean;
    }
};

}  // namespace shadowcache
