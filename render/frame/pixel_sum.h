#pragma once

#include "common/trace/scene.h"
#include "render/estimators/estimate.h"
#include "render/frame/film.h"

namespace shadowcache {

/// Spread of a stream of values, as the variance of their mean: from the means of runs of
/// consecutive values, because the values are stratified and a run's mean has part of the gain.
class RunSpread {
public:
    void add(double value, int runLength) {
        run_ += value;
        if (++inRun_ < runLength) return;
        sum_ += run_;
        squares_ += run_ * run_;
        ++runs_;
        run_ = 0;
        inRun_ = 0;
    }

    /// Of the mean of `count` values; 0 with fewer than two runs. Values of a run begun are left
    /// out.
    double varianceOfMean(int runLength, int count) const;

private:
    double run_ = 0, sum_ = 0, squares_ = 0;
    int inRun_ = 0, runs_ = 0;
};

/// Values of a run for so many camera rays a pass: about the root.
int spreadRunLength(int passRays);

/// What a ray from the film shows of what shines by itself.
struct SeenEmission {
    Rgb surface{0, 0, 0}, lamps{0, 0, 0}, sky{0, 0, 0};

    Rgb sum() const { return surface + lamps + sky; }
};

/// How the spread of camera rays is measured in a frame.
struct SpreadRule {
    int runLength;
    Rgb luminanceWeights;

    double luminance(const Rgb& c) const { return static_cast<double>(luminanceWeights.dot(c)); }
};

/// What a pixel's emission rays add up to so far.
struct EmissionSum {
    int factor = 0;                               ///< AdaptiveRate::emissionFactor
    Rgb emission{0, 0, 0}, environment{0, 0, 0};  ///< as RayValues has them
    RunSpread spread;                             ///< of the luminance
    int rays = 0;

    void add(const SeenEmission& seen, const SpreadRule& rule);
    /// Runs are longer by as much as there are more rays than a pixel usually has.
    int runLength(const SpreadRule& rule) const { return factor * rule.runLength; }
    /// Adds the mean to a pixel that lacks it.
    void addTo(Pixel& pixel, const SpreadRule& rule) const;
};

/// What a pixel's camera rays add up to so far. All weigh the same, as the filter chooses where
/// they go (pixel_filter.h), but where panes are shown more often than rays stop there
/// (Scene::look).
struct PixelSum {
    RayValues values;
    EmissionSum apart;            ///< what the camera rays leave out
    RunSpread color, irradiance;  ///< of the luminance
    int cameraRays = 0;
    float shares = 0;      ///< of these rays: Hit::share
    float variance = 0;    ///< of the irradiance's luminance, from each ray's own samples
    float covariance = 0;  ///< Estimate::covariance
    float glossVariance = 0;
    float expectedVariance = 0;  ///< square of CacheInsight::expectedNoise
    float rays = 0;              ///< shadow rays
    float reusedRays = 0;

    /// Adds a camera ray that sees the sky.
    ///
    /// @param hit  of the ray: its share, and how far it is covered
    void addSky(const SeenEmission& seen, const Hit& hit, const SpreadRule& rule);
    /// Adds a camera ray that meets the set.
    void addHit(const RayValues& ray, const Estimate& estimate, const GlossEstimate& gloss,
                const SpreadRule& rule);
    /// The pixel so far.
    Pixel average(const SpreadRule& rule) const;
};

}  // namespace shadowcache
