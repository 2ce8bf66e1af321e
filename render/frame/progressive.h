#pragma once

#include <functional>

#include "render/frame/integrator.h"

namespace shadowcache {

/// How a progressive frame ended.
enum class FrameEnd { complete, stopped, interrupted };

/// Watches a frame come about.
struct ProgressiveObserver {
    /// Asked often, from several threads; true ends the frame with the last pass that is complete.
    /// A time limit is one (`filmOf`, render/app/run_job.cpp).
    std::function<bool()> stop = [] { return false; };
    /// Has the picture after each pass but the last.
    std::function<void(const Film&, int cameraRays)> onPass = [](const Film&, int) {};
};

/// A frame and how it ended.
struct ProgressiveFrame {
    Film film;
    int cameraRays = 0;  ///< that each pixel has
    FrameEnd end = FrameEnd::complete;
};

/// Renders one frame in passes over all of it, of options.passRays camera rays a pixel each. The
/// first pass is completed whatever `stop` returns; Ctrl-C ends a later one as `stop` does. After n
/// passes the picture has the bits of render() with n times passRays camera rays.
///
/// @throws Error as render()
ProgressiveFrame renderProgressive(const FrameRequest& frame, RenderStats& stats,
                                   const ProgressiveObserver& observer);

}  // namespace shadowcache
