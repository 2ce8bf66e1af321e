#pragma once

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

/// How the spread of camera rays is measured in a frame.
struct SpreadRule {
    int runLength;
    Rgb luminanceWeights;

    double luminance(const Rgb& c) const { return static_cast<double>(luminanceWeights.dot(c)); }
};

/// What a pixel's camera rays add up to so far. All weigh the same: the filter chooses where they
/// go (pixel_filter.h).
struct PixelSum {
    RayValues values;
    RunSpread color, irradiance;  ///< of the luminance
    int cameraRays = 0;
    int hits = 0;          ///< camera rays that meet the set
    float variance = 0;    ///< of the irradiance's luminance, from each ray's own samples
    float covariance = 0;  ///< Estimate::covariance
    float glossVariance = 0;
    float expectedVariance = 0;  ///< square of CacheInsight::expectedNoise
    float rays = 0;              ///< shadow rays
    float reusedRays = 0;

    /// Adds a camera ray that sees the sky.
    ///
    /// @param lamps  radiance of lamps before it
    void addSky(const Rgb& sky, const Rgb& lamps, const SpreadRule& rule);
    /// Adds a camera ray that meets the set.
    void addHit(const RayValues& ray, const Estimate& estimate, const GlossEstimate& gloss,
                const SpreadRule& rule);
    /// The pixel so far.
    Pixel average(const SpreadRule& rule) const;
};

}  // namespace shadowcache
