#include "render/frame/pilot.h"

#include <memory>

#include "render/frame/preview_correction.h"
#include "render/frame/sample_pilot.h"

namespace shadowcache {

FramePlan planFrame(const FrameRequest& frame, RenderStats& stats) {
    if (frame.options.samples > 0) return planSamples(frame, stats);
    FramePlan plan;
    plan.previewCorrection = std::make_shared<const PreviewCorrection>(frame, stats);
    return plan;
}

}  // namespace shadowcache
