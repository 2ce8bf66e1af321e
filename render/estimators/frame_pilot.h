#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "render/estimators/shading_point.h"

namespace shadowcache {

/// What a pilot decides of a frame for its estimator, which derives its own. Immutable once made.
struct EstimatorPlan {
    virtual ~EstimatorPlan() = default;

    /// relMSE of the irradiance at one point, as the pilot's places predict it; none where all
    /// points have the same number of samples.
    std::optional<double> predictedError = {};
    std::uint64_t rays = 0;  ///< shadow rays that it took
};

/// Looks at a frame through a few of its places before any pixel's samples are chosen.
class FramePilot {
public:
    virtual ~FramePilot() = default;

    /// Places on the film that it wants of a frame of `samples` samples in all.
    virtual std::size_t places(std::uint64_t samples) const;

    /// Whether pixels may get other numbers of samples and camera rays than are asked for.
    virtual bool isAdaptive() const { return true; }

    /// @param samples  what each pixel will be given, or their mean where the estimator shares out
    /// @param cameraRayError  relMSE that the camera rays leave, of a pixel with 64 shadow rays
    virtual std::unique_ptr<const EstimatorPlan> plan(std::span<const ShadingPoint> points,
                                                      int samples, double cameraRayError) const = 0;
};

}  // namespace shadowcache
