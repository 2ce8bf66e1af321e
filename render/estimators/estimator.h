#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/base/sequence.h"
#include "common/cache/shadow_cache.h"
#include "common/light/environment.h"
#include "common/trace/scene.h"

namespace shadowcache {

/// What every estimator works with; all outlive it.
struct EstimatorContext {
    const Scene& scene;
    const Environment& environment;
    const ShadowCache* cache;  ///< may be null
    Sequence sequence = Sequence::sobol;
};

/// A place to light.
struct ShadingPoint {
    Vec3f rayOrigin;     ///< off the surface, relative to the mesh's origin
    Vec3d position;      ///< world space
    Vec3f normal;        ///< unit, on the viewer's side
    std::uint64_t seed;  ///< of all random numbers of this point
    int filmX = 0;       ///< pixel of the camera ray that found it
    int filmY = 0;
};

/// Irradiance from the environment and what it took.
struct Estimate {
    Rgb irradiance{0, 0, 0};
    float variance = 0;  ///< of the irradiance's luminance, estimated from the samples themselves
    std::uint32_t rays = 0;
};

/// Directions to test for occlusion, and what each adds to the irradiance if it is open or hidden.
class LightSamples {
public:
    void clear();
    void add(const Vec3f& direction, const Rgb& ifOpen, const Rgb& ifHidden = Rgb(0, 0, 0));
    /// A sample whose contribution is zero whatever a ray would say.
    void addZero() { add(Vec3f(0, 0, 0), Rgb(0, 0, 0)); }
    std::size_t size() const { return direction_.size(); }
    /// Whether sample `i`, whose direction is not zero, was open; after trace().
    bool open(std::size_t i) const { return open_[i] != 0; }
    const Vec3f& direction(std::size_t i) const { return direction_[i]; }

    /// Ends a group of samples that estimate the same thing; the variance is estimated from
    /// differences within groups.
    void endGroup() { groupEnds_.push_back(size()); }

    /// Traces all rays from `point`; the sum of the contributions is added to `estimate`.
    void trace(const Scene& scene, const ShadingPoint& point, const Environment& environment,
               Estimate& estimate);

private:
    std::vector<Vec3f> direction_;
    std::vector<Rgb> ifOpen_, ifHidden_;
    std::vector<std::uint8_t> open_;
    std::vector<std::size_t> groupEnds_;
};

/// Scratch memory of one thread; estimators derive their own.
struct Workspace {
    virtual ~Workspace() = default;

    LightSamples samples;
    std::uint64_t setupNanoseconds = 0;
    std::uint64_t traceNanoseconds = 0;

    /// The first `count` numbers of dimension `dimension`; valid until the next call with that
    /// dimension.
    std::span<const std::uint32_t> numbers(Sequence sequence, std::uint64_t seed, int dimension,
                                           int count);

private:
    std::vector<std::uint32_t> numbers_[4];
};

/// Looks at a frame through a few of its places before any pixel's samples are chosen.
class FramePilot {
public:
    virtual ~FramePilot() = default;

    /// Replaces whatever was learned from earlier frames.
    ///
    /// @param samples  what each pixel will be given, or their mean where the estimator shares out
    /// @return number of shadow rays it took
    virtual std::uint64_t run(std::span<const ShadingPoint> points, int samples) = 0;
};

/// What the cache says of a place before any ray is traced there.
struct CacheInsight {
    float openness = 0;       ///< open share of the sky, weighted by the cosine
    float expectedNoise = 0;  ///< standard deviation expected of the irradiance's luminance
    int items = 0;            ///< cache items found
    int regions = 0;          ///< regions that samples are drawn from
};

/// Tells what the cache says of a place.
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

    /// Lights points that are near each other, from `samples` samples at each, and keeps the time;
    /// estimates[i] is that of points[i]. Points may gain from what the others' rays find.
    virtual void estimate(std::span<const ShadingPoint> points, int samples, Workspace& workspace,
                          std::span<Estimate> estimates) const = 0;
    /// The same at one point; workspace.samples are its samples afterwards.
    Estimate estimate(const ShadingPoint& point, int samples, Workspace& workspace) const;

    /// Null where frames need no pilot.
    virtual FramePilot* pilot() { return nullptr; }
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

    void estimate(std::span<const ShadingPoint> points, int samples, Workspace& workspace,
                  std::span<Estimate> estimates) const override;

protected:
    /// Fills workspace.samples with the directions to test, decided before any ray is traced.
    ///
    /// @return the part of the irradiance that needs no ray
    virtual Rgb prepare(const ShadingPoint& point, int samples, Workspace& workspace) const = 0;
};

/// Nanoseconds since this was made, or since the last call.
class Stopwatch {
public:
    std::uint64_t sinceLast();

private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace shadowcache
