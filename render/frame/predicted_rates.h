#pragma once

#include <span>
#include <vector>

#include "render/frame/film_rays.h"
#include "render/frame/tile_tools.h"

namespace shadowcache {

/// What `count` camera rays of each of some pixels are predicted to see; they are none of the
/// picture's.
///
/// @return of each pixel: nothing where the estimator predicts nothing
std::vector<PredictedSpread> predictSpreads(const FrameRequest& frame, const FilmRays& film,
                                            std::span<const FilmPlace> places, int count,
                                            TileTools& tools);

/// How the pixels of a tile are sampled, by the frame's AntialiasingRule; without one, alike.
std::vector<AdaptiveRate> ratesOf(const FrameRequest& frame, const FilmRays& film,
                                  std::span<const FilmPlace> places, TileTools& tools);

}  // namespace shadowcache
