#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/base/sequence.h"
#include "common/cache/shadow_cache.h"
#include "common/light/environment.h"
#include "common/trace/scene.h"
#include "render/cached/cache_insight.h"

namespace shadowcache {

struct EstimatorOptions {
    Sequence sequence = Sequence::sobol;
    bool adaptive = false;  ///< `cache`: share the frame's samples out by predicted noise
    int triangles = 5000;   ///< `paper`: M, 20 .. 100000
    int minLevel = 3;       ///< `paper`: least level of the triangulation
    int maxLevel = 6;       ///< `paper`: highest level, 0 .. 7
    double alpha = 0.7;     ///< `paper`: trust in the cache, [0, 1)
    int threshold = 3;      ///< `paper`: fewest pooled rays of a region that count
    double beta = 0;        ///< `paper`: share of samples uniform over the hemisphere, [0, 1]
    int order = 0;          ///< `paper`: importance in a triangle constant (0) or linear (1)
    bool exactConvolution = false;  ///< `paper`: convolutions at the normal itself, no tables
    int cacheLevel = 7;             ///< `paper`: finest level of the counts it uses, 0 .. 7
    int lights = 40;                ///< `lights`: K, 1 .. 10000
    int pixelWidth = 200;           ///< `pixel`: low-resolution map, 8x4 .. 4096x2048
    int pixelHeight = 100;
};

/// What every estimator works with; all outlive it.
struct EstimatorContext {
    const Scene& scene;
    const Environment& environment;
    const ShadowCache* cache;  ///< may be null
    EstimatorOptions options;
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

/// An estimator of the irradiance at a point. Immutable while rendering; thread-safe through one
/// workspace a thread.
class Estimator {
public:
    explicit Estimator(const EstimatorContext& context) : context_(context) {}
    virtual ~Estimator() = default;
    Estimator(const Estimator&) = delete;
    Estimator& operator=(const Estimator&) = delete;

    virtual std::unique_ptr<Workspace> makeWorkspace() const;

    /// Looks at a frame through a few of its places before any pixel's samples are chosen: whatever
    /// estimators learned from earlier frames is replaced.
    ///
    /// @param samples  what each pixel will be given, or their mean where the estimator shares out
    /// @return number of shadow rays it took
    virtual std::uint64_t survey(std::span<const ShadingPoint> points, int samples);

    /// What the cache says of the place, before any ray; nothing where the estimator needs none.
    virtual CacheInsight insight(const ShadingPoint& point, int samples,
                                 Workspace& workspace) const;

    /// Whether estimates depend on earlier ones of the same workspace, so that a frame must be
    /// rendered in one fixed order.
    virtual bool inOrder() const { return false; }

    /// Estimates from `samples` samples at each point: queues them, traces them, keeps the
    /// time. Points that are near each other may gain from what the others' rays find.
    void estimate(std::span<const ShadingPoint> points, int samples, Workspace& workspace,
                  std::span<Estimate> estimates) const;
    /// The same at one point; workspace.samples are its samples afterwards.
    Estimate estimate(const ShadingPoint& point, int samples, Workspace& workspace) const;

protected:
    /// Fills workspace.samples with the directions to test, decided before any ray is traced.
    ///
    /// @return the part of the irradiance that needs no ray
    virtual Rgb prepare(const ShadingPoint& point, int samples, Workspace& workspace) const = 0;

    /// Looks at workspace.samples of one point after its rays are traced, if there are any.
    virtual void takeNote(Workspace& workspace) const;
    /// Called once the rays of all points are traced, to exchange what was found.
    virtual void exchange(std::span<const ShadingPoint> points, Workspace& workspace,
                          std::span<Estimate> estimates) const;

    const EstimatorContext context_;
};

/// One line of the table of estimators.
struct EstimatorEntry {
    const char* name;
    const char* summary;
    int minSamples;
    bool needsCache;
    std::unique_ptr<Estimator> (*make)(const EstimatorContext&);
    const char* bias = nullptr;  ///< what its expectation leaves out or gets wrong; null: nothing
};

/// How the estimates of `samples` samples are biased: "none", or the cause.
std::string biasOf(const EstimatorEntry& entry, int samples);

/// Every estimator that `--estimator` offers.
std::span<const EstimatorEntry> estimatorTable();

/// @throws Error naming the estimators there are
const EstimatorEntry& findEstimator(const std::string& name);

}  // namespace shadowcache
