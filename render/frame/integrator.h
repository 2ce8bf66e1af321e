#pragma once

#include <span>
#include <vector>

#include "render/frame/film.h"
#include "render/frame/frame_request.h"

namespace shadowcache {

/// Renders one frame: what surfaces reflect of the environment, and emit; the sky where nothing is
/// hit. The same bits for any number of threads, and for a crop as for the whole frame. Shows
/// progress; Ctrl-C ends it with Error.
///
/// @throws Error on non-finite estimates, with their number and the options that replay the first
Film render(const FrameRequest& frame, RenderStats& stats);

/// The pixels of some tiles of the region, by their numbers in the order of Tiles::touching; each
/// has those camera rays that it has in the frame.
std::vector<std::vector<Pixel>> renderSomeTiles(const FrameRequest& frame,
                                                std::span<const std::size_t> numbers,
                                                RenderStats& stats);

/// The pixel (x, y) of the frame, bit for bit as render() makes it; `observer` sees each camera ray
/// that meets the set.
Pixel renderPixel(const FrameRequest& frame, int x, int y, const CameraSampleObserver& observer);

}  // namespace shadowcache
