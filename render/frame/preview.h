#pragma once

#include "render/frame/film.h"
#include "render/frame/frame_request.h"

namespace shadowcache {

// A preview shows the prediction, and what rays add to it smoothed: predicted + filter(estimate -
// predicted). Shadows that are predicted are not blurred. Biased, and consistent: the filter does
// less as the noise falls. [docs/estimator.md]

/// The frame with all pixels that its region depends on; itself unless it is a preview.
FrameRequest withPreviewMargin(const FrameRequest& frame);

/// What is delivered of a film of withPreviewMargin(frame): its region; of a preview with colour,
/// irradiance and their variances filtered; without samples, as the plan corrects it. Adds the time
/// to the statistics.
Film finishFilm(const FrameRequest& frame, Film film, RenderStats& stats);

}  // namespace shadowcache
