#pragma once

#include <memory>
#include <optional>

#include "render/estimators/frame_pilot.h"
#include "render/frame/antialiasing.h"

namespace shadowcache {

class PreviewCorrection;
class VisibleEmitters;

/// All that is decided of a frame before any of its pixels. As it is made: what holds without a
/// pilot.
struct FramePlan {
    /// By the estimator's pilot; null: none looked at the frame. Copies of a request share it.
    std::shared_ptr<const EstimatorPlan> estimator = {};
    /// The same for vertices of paths; `estimator` where no paths were sent.
    std::shared_ptr<const EstimatorPlan> vertices = {};
    /// What spreads of pixels contain beside what a few rays meet; null: nothing.
    std::shared_ptr<const VisibleEmitters> visibleEmitters = {};
    /// None: each pixel has just the camera rays that are asked for.
    std::optional<AntialiasingRule> antialiasing = {};
    /// What is added to a picture without samples; null: nothing.
    std::shared_ptr<const PreviewCorrection> previewCorrection = {};
    /// BounceOptions::trust.
    float bounceTrust = 1;
};

}  // namespace shadowcache
