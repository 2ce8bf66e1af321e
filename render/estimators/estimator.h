#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/cache/shadow_cache.h"
#include "common/light/environment.h"
#include "common/predict/bounce_solve.h"
#include "common/random/sequence.h"
#include "common/surface/surface.h"
#include "common/trace/scene.h"

namespace shadowcache {

/// What every estimator works with; all outlive it.
struct EstimatorContext {
    const Scene& scene;
    const Environment& environment;
    const ShadowCache* cache;  ///< may be null
    Sequence sequence = Sequence::sobol;
    /// What the cache predicts of the light that bounces under this environment; may be null.
    const BounceSolve* solve = nullptr;
};

/// A place to light.
struct ShadingPoint {
    Vec3f rayOrigin;        ///< off the surface, relative to the mesh's origin
    Vec3d position;         ///< world space
    Vec3f normal;           ///< unit shading normal, on the viewer's side
    Vec3f geometricNormal;  ///< unit, on that side of the surface: for lookups
    std::uint64_t seed;     ///< of the pixel: all of its camera rays draw from one sequence
    int filmX = 0;          ///< pixel of the camera ray that found it
    int filmY = 0;
    std::uint32_t cameraRay = 0;  ///< number of that ray in its pixel
    std::uint32_t row = 0;  ///< of the camera rays asked for in the batch, which one; f of a pixel
                            ///< that has f times as many are in one row, one after another
    std::uint32_t pixel = 0;  ///< number of the pixel in its batch
    /// Irradiance that errors of its light are relative to: what would make the point as bright as
    /// its pixel is predicted to be. 0: its own light.
    float errorScale = 0;
    float share = 1;  ///< of the samples wanted: below 1 where the pixel has more camera rays
};

/// Points that are lit together: what the camera rays of some neighbouring pixels meet, pixel by
/// pixel along a Morton curve and in a pixel by camera ray. A ray that meets the sky has no point.
struct PointBatch {
    std::span<const ShadingPoint> points;
    int samples = 1;                 ///< wanted of each point, times its share
    std::uint32_t pixels = 1;        ///< numbers of pixels are below it
    std::uint32_t cameraRays = 1;    ///< most of a pixel
    std::uint32_t pixelSamples = 1;  ///< of a pixel, over all batches
    bool predict = false;            ///< Estimate::predicted is wanted
};

/// A point's samples among those of its pixel, which share one sequence.
struct SampleSlice {
    std::uint32_t first = 0;  ///< number of the point's first sample
    int count = 1;            ///< of the point
    std::uint32_t total = 1;  ///< of the pixel
};

/// That of a point of a batch.
inline SampleSlice sliceOf(const PointBatch& batch, const ShadingPoint& point) {
    return {point.cameraRay * static_cast<std::uint32_t>(batch.samples), batch.samples,
            batch.pixelSamples};
}

/// Irradiance from the environment and what it took.
struct Estimate {
    Rgb irradiance{0, 0, 0};
    Rgb predicted{0, 0, 0};  ///< irradiance predicted without rays, if PointBatch::predict
    float variance = 0;    ///< of the irradiance's luminance, estimated from the samples themselves
    float covariance = 0;  ///< sum of the covariances with the other points of its pixel
    std::uint32_t rays = 0;    ///< traced for this point's own samples
    std::uint32_t reused = 0;  ///< traced to reuse what other points found
};

/// A place on a glossy surface, and what it reflects to the viewer.
struct GlossyPoint {
    const ShadingPoint& point;
    GlossyLobe lobe;
};

/// Radiance that a lobe reflects to the viewer, and what it took.
struct GlossEstimate {
    Rgb radiance{0, 0, 0};
    float variance = 0;  ///< of its luminance, estimated from the samples themselves
    std::uint32_t rays = 0;
};

/// Directions to test for occlusion, and what each adds to the irradiance if it is visible or
/// occluded.
class LightSamples {
public:
    void clear();
    void add(const Vec3f& direction, const Rgb& ifVisible, const Rgb& ifOccluded = Rgb(0, 0, 0));
    /// A sample whose contribution is zero whether visible or not.
    void addZero() { add(Vec3f(0, 0, 0), Rgb(0, 0, 0)); }
    std::size_t size() const { return direction_.size(); }
    /// Whether sample `i`, whose direction is not zero, was visible; after trace().
    bool visible(std::size_t i) const { return visible_[i] != 0; }
    const Vec3f& direction(std::size_t i) const { return direction_[i]; }

    /// Ends a group of samples that estimate the same thing; the variance is estimated from
    /// differences within groups.
    void endGroup() { groupEnds_.push_back(size()); }

    /// Traces all rays from `point`; the sum of the contributions is added to `estimate`.
    void trace(const Scene& scene, const ShadingPoint& point, const Environment& environment,
               Estimate& estimate);

private:
    std::vector<Vec3f> direction_;
    std::vector<Rgb> ifVisible_, ifOccluded_;
    std::vector<std::uint8_t> visible_;
    std::vector<std::size_t> groupEnds_;
};

/// A sample of a pixel that is watched.
struct WatchedSample {
    std::uint32_t cameraRay;
    Vec3f direction;  ///< zero: no ray, contributes nothing
};

/// Scratch memory of one thread; estimators derive their own.
struct Workspace {
    virtual ~Workspace() = default;

    /// A pixel of the batch whose own samples are to be noted, for reports.
    std::optional<std::uint32_t> watchedPixel;
    std::vector<WatchedSample> watched;

    void watch(const ShadingPoint& point, const Vec3f& direction) {
        if (watchedPixel == point.pixel) watched.push_back({point.cameraRay, direction});
    }

    LightSamples samples;
    std::uint64_t setupNanoseconds = 0;
    std::uint64_t traceNanoseconds = 0;
    std::uint64_t pointsWithoutItems = 0;  ///< lit without what a cache knows

    /// Numbers `first` to `first + count - 1` of dimension `dimension` in a sequence of `total`;
    /// valid until the next call with that dimension.
    std::span<const std::uint32_t> numbers(Sequence sequence, std::uint64_t seed, int dimension,
                                           std::uint32_t first, int count, std::uint32_t total);

private:
    std::vector<std::uint32_t> numbers_[4];
};

/// Looks at a frame through a few of its places before any pixel's samples are chosen.
class FramePilot {
public:
    virtual ~FramePilot() = default;

    /// Places on the film that it wants of a frame of `samples` samples in all.
    virtual std::size_t places(std::uint64_t samples) const;

    /// Replaces whatever was learned from earlier frames.
    ///
    /// @param samples  what each pixel will be given, or their mean where the estimator shares out
    /// @param otherError  relMSE that the camera rays leave, of a pixel with 64 shadow rays
    /// @return number of shadow rays it took
    virtual std::uint64_t run(std::span<const ShadingPoint> points, int samples,
                              double otherError) = 0;
};

/// What the cache predicts at a place before any ray is traced there.
struct CacheInsight {
    float openness = 0;       ///< visible share of the sky, weighted by the cosine
    float expectedNoise = 0;  ///< standard deviation expected of the irradiance's luminance
    int items = 0;            ///< cache items found
    int regions = 0;          ///< regions that samples are drawn from
};

/// Irradiance predicted without rays.
class LightPrediction {
public:
    virtual ~LightPrediction() = default;
    /// @return [radiance sr]
    virtual Rgb predict(const ShadingPoint& point, Workspace& workspace) const = 0;
    /// relMSE of the irradiance at one point, as the last pilot's places predict it; none where the
    /// estimator gives all points the same number of samples.
    virtual std::optional<double> predictedError() const = 0;
};

/// Reports what the cache predicts at a place.
class InsightSource {
public:
    virtual ~InsightSource() = default;
    virtual CacheInsight insight(const ShadingPoint& point, int samples,
                                 Workspace& workspace) const = 0;
};

/// An estimator of irradiance. Immutable while rendering; thread-safe through one workspace a
/// thread. Most derive from PointEstimator.
class Estimator {
public:
    explicit Estimator(const EstimatorContext& context) : context_(context) {}
    virtual ~Estimator() = default;
    Estimator(const Estimator&) = delete;
    Estimator& operator=(const Estimator&) = delete;

    const EstimatorContext& context() const { return context_; }

    virtual std::unique_ptr<Workspace> makeWorkspace() const;

    /// Lights the points of a batch and keeps the time; estimates[i] is that of points[i]. Points
    /// may gain from what the others' rays find.
    virtual void estimate(const PointBatch& batch, Workspace& workspace,
                          std::span<Estimate> estimates) const = 0;
    /// The same of points that are the only ones of their pixels.
    void estimate(std::span<const ShadingPoint> points, int samples, Workspace& workspace,
                  std::span<Estimate> estimates) const;
    /// The same at one point.
    Estimate estimate(const ShadingPoint& point, int samples, Workspace& workspace) const;

    /// What the lobes of glossy points reflect, with as many samples of each point as the batch
    /// wants for the irradiance: from the map and from the lobe, weighted by the balance heuristic.
    /// @param points  of a batch's, in its order
    virtual void estimateGloss(const PointBatch& batch, std::span<const GlossyPoint> points,
                               Workspace& workspace, std::span<GlossEstimate> estimates) const;

    /// Null where frames need no pilot.
    virtual FramePilot* pilot() { return nullptr; }
    /// Null where nothing is predicted.
    virtual const LightPrediction* prediction() const { return nullptr; }
    /// Null where no cache is read.
    virtual const InsightSource* insights() const { return nullptr; }
    /// Whether estimates depend on earlier ones of the same workspace, so that a frame must be
    /// rendered in one fixed order.
    virtual bool inOrder() const { return false; }

protected:
    const EstimatorContext context_;
};

/// An estimator that lights each point by itself.
class PointEstimator : public Estimator {
public:
    using Estimator::estimate;
    using Estimator::Estimator;

    void estimate(const PointBatch& batch, Workspace& workspace,
                  std::span<Estimate> estimates) const override;

protected:
    /// Fills workspace.samples with the directions to test, decided before any ray is traced.
    ///
    /// @return the part of the irradiance that needs no ray
    virtual Rgb prepare(const ShadingPoint& point, const SampleSlice& slice,
                        Workspace& workspace) const = 0;
};

/// Nanoseconds since this was made, or since the last call.
class Stopwatch {
public:
    std::uint64_t sinceLast();

private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace shadowcache
