#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "common/base/tuned.h"
#include "render/frame/adaptive_rate.h"
#include "render/frame/tiles.h"

namespace shadowcache {

/// Most camera rays of a pixel that decide how many it gets.
inline constexpr int kMostSpreadRays = 4;

/// Which pixels get more camera rays than asked for, and as many fewer samples with each: those
/// whose camera rays are predicted to see such different things that more rays pay. Where what
/// shines by itself differs, rays pay that look for this alone. Decided by predictions alone, at
/// camera rays that are not the picture's, so that it adds no bias.
struct AntialiasingRule {
    /// Square of the luminance below which errors are absolute, as relMSE has it.
    double floor = 0;
    /// Relative variance of one camera ray from which on twice the camera rays as asked for pay.
    double least = 0;
    /// Most camera rays of a pixel for each that is asked for; 1: as many as asked for everywhere.
    int most = 4;
    /// Most of its emission rays for each; 1: none anywhere.
    int mostEmission = 1;
};

/// The error of M camera rays of a pixel is that of one over M to this power, about: they are
/// stratified. 1 if they were not, 3/2 at a straight edge.
inline SHADOWCACHE_TUNED(double, kStratification, 1.33);

/// First and second moment of some luminances, times their count.
struct Moments {
    double sum = 0, squares = 0;

    void add(double luminance, double weight = 1) {
        sum += weight * luminance;
        squares += weight * luminance * luminance;
    }
    void add(const Moments& other, double weight) {
        sum += weight * other.sum;
        squares += weight * other.squares;
    }
};

/// Variances of what one camera ray of a pixel shows, over the squared mean of all of it.
struct PixelVariances {
    double all = 0;
    double reflected = 0;  ///< of what surfaces reflect
    double emitted = 0;    ///< of what surfaces and lamps emit, and the sky
};

/// Luminance that some camera rays of a pixel are predicted to see, summed up.
struct PredictedSpread {
    double count = 0;
    Moments all = {}, reflected = {}, emitted = {};  ///< as of PixelVariances

    void add(double reflectedThere, double emittedThere) {
        count += 1;
        all.add(reflectedThere + emittedThere);
        reflected.add(reflectedThere);
        emitted.add(emittedThere);
    }
    /// Adds another's with a weight.
    void add(const PredictedSpread& other, double weight) {
        count += weight * other.count;
        all.add(other.all, weight);
        reflected.add(other.reflected, weight);
        emitted.add(other.emitted, weight);
    }
    double mean() const { return count > 0 ? all.sum / count : 0; }
    /// Luminance that errors of the pixel are relative to.
    double errorScale(double floor) const { return std::sqrt(mean() * mean() + floor); }
    /// Over the squared mean plus `floor`.
    PixelVariances variances(double floor) const;
};

/// How much the camera rays of a pixel are predicted to differ in a frame.
struct FrameSpread {
    double floor = 0;                       ///< as AntialiasingRule has it
    double cameraError = 0;                 ///< relMSE of one camera ray, if its light were known
    std::vector<PixelVariances> variances;  ///< of some pixels
};

/// From some of the frame's pixels.
FrameSpread spreadOf(std::span<const PredictedSpread> pixels);

/// @param lightError           relMSE of one camera ray's samples
/// @param cameraRays, samples  as asked for; of a pass, so that n passes are those of the whole
AntialiasingRule makeAntialiasingRule(const FrameSpread& frame, double lightError, int cameraRays,
                                      int samples);

/// The spread of each pixel of a tile together with those beside it in the tile, which count less.
///
/// @param spreads  of the pixels at `places`
std::vector<PredictedSpread> withNeighbors(std::span<const FilmPlace> places,
                                           std::span<const PredictedSpread> spreads);

/// Rays of a pixel that pay.
AdaptiveRate rateOf(const PredictedSpread& pixel, const AntialiasingRule& rule);

}  // namespace shadowcache
