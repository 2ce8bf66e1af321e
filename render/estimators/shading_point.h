#pragma once

#include <cstdint>
#include <span>

#include "common/cache/item_table.h"
#include "common/math/vec.h"
#include "common/surface/surface.h"

namespace shadowcache {

/// A place on the set, from one side.
struct SetPlace {
    Vec3f rayOrigin;        ///< off the surface, relative to the mesh's origin
    Vec3d position;         ///< world space
    Vec3f normal;           ///< unit shading normal, on the viewer's side
    Vec3f geometricNormal;  ///< unit, on that side of the surface: for lookups
};

/// Where a point belongs: its number among the points that are lit with it, and its pixel.
struct BatchSlot {
    std::uint64_t seed = 0;  ///< of the pixel: all of its camera rays draw from one sequence
    int filmX = 0;           ///< pixel of the camera ray that found it
    int filmY = 0;
    std::uint32_t cameraRay = 0;  ///< number of that ray in its pixel
    std::uint32_t row = 0;  ///< of the camera rays asked for in the batch, which one; f of a pixel
                            ///< that has f times as many are in one row, one after another
    std::uint32_t pixel = 0;  ///< number of the pixel in its batch
    /// Irradiance that errors of its light are relative to: what would make the point as bright as
    /// its pixel is predicted to be. 0: its own light.
    float errorScale = 0;
    /// Of the samples wanted: below 1 where the pixel has more camera rays than were asked for.
    float sampleFraction = 1;
    /// By which the point's irradiance counts in the picture, beside the batch's others: where
    /// predicted light of emitters times this is above the mean, they get up to kMostEmitterSamples
    /// times as many samples. All 0: alike.
    float importance = 0;
    std::uint32_t item = kNoItem;  ///< of the cache that counts for the place, if it is known
};

/// A place to light, and where its light goes.
struct ShadingPoint {
    SetPlace place;
    BatchSlot slot;
};

/// A place on a glossy surface, and what it reflects to the viewer.
struct GlossyPoint {
    const ShadingPoint& point;
    GlossyLobe lobe;
};

struct EstimatorPlan;

/// Points that are lit together: what the camera rays of some neighbouring pixels meet, pixel by
/// pixel along a Morton curve and in a pixel by camera ray. A ray that meets the sky has no point.
struct PointBatch {
    std::span<const ShadingPoint> points;
    int samples = 1;                      ///< wanted of each point, times its fraction
    std::uint32_t pixels = 1;             ///< numbers of pixels are below it
    std::uint32_t cameraRays = 1;         ///< most of a pixel
    bool predict = false;                 ///< Estimate::predicted is wanted
    const EstimatorPlan* plan = nullptr;  ///< the frame's, by the estimator's pilot; may be null
};

/// A point's samples among those of its pixel, which share one sequence.
struct SampleSlice {
    std::uint32_t first = 0;  ///< number of the point's first sample
    int count = 1;            ///< of the point
};

/// The slice of a point of a batch.
inline SampleSlice sliceOf(const PointBatch& batch, const BatchSlot& slot) {
    return {slot.cameraRay * static_cast<std::uint32_t>(batch.samples), batch.samples};
}

}  // namespace shadowcache
