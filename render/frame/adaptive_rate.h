#pragma once

namespace shadowcache {

/// How a pixel is sampled: decided by predictions, before any of its camera rays.
struct AdaptiveRate {
    int rayFactor = 1;       ///< camera rays for each that is asked for
    int emissionFactor = 0;  ///< rays for each that show what emits, in place of the camera rays;
                             ///< 0: camera rays show it
    double errorScale = 0;   ///< luminance that its errors are relative to; 0: not predicted
};

}  // namespace shadowcache
