#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/shot/view.h"
#include "render/bounces/bounce_task.h"
#include "render/estimators/estimator.h"
#include "render/frame/adaptive_rate.h"
#include "render/frame/tiles.h"

namespace shadowcache {

/// Camera rays `first` to `first + count - 1` of a pixel.
struct RayRange {
    int first = 0, count = 0;
};

/// Which camera rays make a batch: the same of each of some pixels of a tile.
struct BatchPixels {
    std::span<const FilmPlace> places;
    std::span<const AdaptiveRate> rates;  ///< of these pixels
    RayRange rays;                        ///< asked for; rates multiply them
};

/// A camera ray and what it meets.
struct FilmRay {
    std::uint32_t pixel = 0;  ///< number in its batch
    int number = 0;           ///< of the pixel's camera rays
    CameraRay ray;
    View view;         ///< no hit: the sky
    float chance = 0;  ///< as CameraPacket has it
};

/// A place on the set that a camera ray met.
struct MetPlace {
    ShadingPoint point;
    Surface surface;
    Rgb diffuseAlbedo;
    float share;                                ///< Hit::share, by which `surface` is scaled
    std::optional<std::uint32_t> diffuse = {};  ///< number in MetPlaces::points; none: not diffuse
    std::optional<std::uint32_t> glossy = {};   ///< number in MetPlaces::glossyPoints
};

/// The places that the camera rays of a batch met, in the order of the rays.
struct MetPlaces {
    std::vector<MetPlace> places;
    std::vector<ShadingPoint> points;       ///< whose irradiance is wanted
    std::vector<GlossyPoint> glossyPoints;  ///< whose reflection is wanted; they refer to `places`
};

/// Light of these places that comes from the environment directly.
struct DirectLight {
    std::vector<Estimate> irradiance;    ///< of MetPlaces::points
    std::vector<GlossEstimate> gloss;    ///< of MetPlaces::glossyPoints
    std::vector<CacheInsight> insights;  ///< of MetPlaces::places; empty: none are wanted
    std::vector<WatchedSample> watched;  ///< of the pixel that is watched
    GroupedLight groupedIrradiance{}, groupedGloss{};  ///< the same by light group
};

/// Camera rays from the film to their light.
struct RayBatch {
    std::size_t firstPixel;  ///< of the tile
    std::vector<FilmRay> rays;
    MetPlaces met;
    DirectLight direct;
    std::vector<BouncedLight> bounced;  ///< of met.places; empty: no light bounces
    GroupedBounce groupedBounced{};
};

}  // namespace shadowcache
