#pragma once

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

/// What a pixel's camera rays add up to so far.
struct PixelSum {
    Pixel sum;                    ///< `variance` of each ray's own samples
    float expectedVariance = 0;   ///< square of CacheInsight::expectedNoise
    RunSpread color, irradiance;  ///< of the luminance
    int cameraRays = 0;
    int rayFactor = 1;      ///< camera rays for each that is asked for
    double errorScale = 0;  ///< luminance that its errors are relative to; 0: not predicted
    int hits = 0;           ///< camera rays that meet the set
};

/// The pixel so far.
///
/// @param runLength  as the spreads were added with
Pixel averageOf(const PixelSum& sum, int runLength, const Rgb& luminanceWeights);

}  // namespace shadowcache
