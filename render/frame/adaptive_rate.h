#pragma once

namespace shadowcache {

/// How a pixel is sampled: decided by predictions, before any of its camera rays.
struct AdaptiveRate {
    int rayFactor = 1;      ///< camera rays for each that is asked for
    double errorScale = 0;  ///< luminance that its errors are relative to; 0: not predicted
};

}  // namespace shadowcache
