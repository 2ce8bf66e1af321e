#pragma once

#include <functional>

#include "render/estimators/estimator.h"
#include "render/frame/camera.h"
#include "render/frame/film.h"
#include "render/frame/options.h"

namespace shadowcache {

/// What rendering took.
struct RenderStats {
    double seconds = 0;
    double setupSeconds =
        0;  ///< of it in the estimator's set-up, summed over threads and divided by them
    double traceSeconds = 0;  ///< of it in tracing shadow rays and adding them up, likewise
    std::uint64_t cameraRays = 0;
    std::uint64_t shadowRays = 0;
    std::uint64_t reusedRays = 0;  ///< those of shadowRays that reuse what other pixels found
    int samples = 0;               ///< of a camera ray, in the last frame
    double ownError = 0;           ///< relMSE of the last frame as its own samples tell it
};

/// A frame to render.
struct FrameRequest {
    Estimator& estimator;
    Camera camera;
    int number;
    RenderOptions options;
};

/// Everything random about a sample is a pure function of (seed, frame, pixel, camera ray, index,
/// dimension).
std::uint64_t pixelSeed(std::uint64_t seed, int frame, int x, int y, int cameraRay);

/// Lets the estimator's pilot look at the frame before it is rendered, through a few of its pixels.
void runPilot(const FrameRequest& frame, RenderStats& stats);

/// Renders one frame: direct light of the environment on Lambertian surfaces, the sky where nothing
/// is hit. The same bits for any number of threads, and for a crop as for the whole frame. Shows
/// progress; Ctrl-C ends it with Error.
///
/// @throws Error on non-finite estimates, with their number and the options that replay the first
Film render(const FrameRequest& frame, RenderStats& stats);

/// The pixels of one tile in `apart` of the region, chosen by the seed.
std::vector<Pixel> renderSomeTiles(const FrameRequest& frame, int apart, RenderStats& stats);

/// One camera ray's place on the set and the estimate there; `samples` are those it was made of.
struct CameraSample {
    const ShadingPoint& point;
    const Rgb& albedo;
    const Estimate& estimate;
    const LightSamples& samples;
};
using CameraSampleObserver = std::function<void(const CameraSample&)>;

/// The pixel (x, y) of the frame, bit for bit as render() makes it; `observer` sees each camera ray
/// that meets the set.
Pixel renderPixel(const FrameRequest& frame, int x, int y, const CameraSampleObserver& observer);

}  // namespace shadowcache
