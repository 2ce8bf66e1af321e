#pragma once

#include <functional>
#include <span>

#include "render/frame/frame_request.h"
#include "render/frame/pixel_sum.h"
#include "render/frame/ray_batch.h"

namespace shadowcache {

/// How the spread of a frame's camera rays is measured.
SpreadRule spreadRuleOf(const FrameRequest& frame);

/// Adds the camera rays of a batch, with all of their light, to a tile's pixels: without what emits
/// where emission rays look for it.
void addToFilm(const FrameRequest& frame, const SpreadRule& rule, const RayBatch& batch,
               std::span<PixelSum> tile);

/// Adds their colours by light group to those of a tile's pixels.
///
/// @param sums  of these pixels
void addToGroups(const FrameRequest& frame, const RayBatch& batch, std::span<const PixelSum> sums,
                 GroupedLight& tile);

/// Has an observer see the camera rays of a pixel of the film that meet the set.
void showTo(const CameraSampleObserver& observer, const FilmPlace& pixel, const FrameRequest& frame,
            const RayBatch& batch);

}  // namespace shadowcache
