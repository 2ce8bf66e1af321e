#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "common/shot/camera.h"
#include "common/surface/surface.h"
#include "render/bounces/bounce_task.h"
#include "render/estimators/estimator.h"
#include "render/frame/frame_plan.h"
#include "render/frame/options.h"

namespace shadowcache {

/// What rendering took.
struct RenderStats {
    double seconds = 0;
    /// Of it in the estimator's set-up, summed over threads and divided by their number.
    double setupSeconds = 0;
    double traceSeconds = 0;  ///< of it in tracing shadow rays and adding them up, likewise
    std::uint64_t cameraRays = 0;
    std::uint64_t spreadRays = 0;    ///< camera rays beside them: they decide how many a pixel gets
    std::uint64_t emissionRays = 0;  ///< rays from the film that look for what emits alone
    std::uint64_t shadowRays = 0;
    /// Of them met the set where the cache that is used holds no item.
    std::uint64_t raysWithoutItems = 0;
    BounceCounts bounces;          ///< rays of the light that bounces
    std::uint64_t reusedRays = 0;  ///< those of shadowRays that reuse what other pixels found
    int samples = 0;               ///< of a camera ray, in the last frame
    double cameraRaysAPixel = 0;   ///< in the last frame, on the mean
    double ownError = 0;           ///< relMSE of the last frame, estimated from its own samples
};

/// A frame to render.
struct FrameRequest {
    const Estimator& estimator;
    CameraMove camera;
    int number;
    RenderOptions options;
    /// Camera rays asked for of the pixels of each tile that the region touches, 1 ..
    /// options.cameraRays, in the order of Tiles::touching; empty: options.cameraRays everywhere.
    std::vector<int> tileRays = {};
    FramePlan plan = {};  ///< by planFrame()

    int raysOfTile(std::size_t tile) const {
        return tileRays.empty() ? options.cameraRays : tileRays[tile];
    }
};

/// One camera ray's place on the set, the estimate there, and the directions of its own samples; a
/// zero one has no ray.
struct CameraSample {
    const ShadingPoint& point;
    const Surface& surface;  ///< times `share`
    float share;             ///< Hit::share
    const Estimate& estimate;
    const GlossEstimate& gloss;
    const std::vector<Vec3f>& directions;
};
using CameraSampleObserver = std::function<void(const CameraSample&)>;

/// Everything random about a sample is a pure function of (seed, frame, pixel, camera ray, index,
/// dimension).
std::uint64_t pixelSeed(std::uint64_t seed, int frame, int x, int y, int cameraRay);

}  // namespace shadowcache
