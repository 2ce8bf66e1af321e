#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/image/image.h"
#include "common/predict/grouped_light.h"

namespace shadowcache {

/// What a camera ray shows; of a pixel, the mean of its camera rays. World space. Camera rays
/// count by their shares (Scene::look), which may sum to a little more or less than their number:
/// of what is no light the mean is that by the shares.
struct RayValues {
    Rgb color{0, 0, 0};            ///< outgoing radiance, or the sky's: the sum of the next three
    Rgb diffuse{0, 0, 0};          ///< irradiance times diffuseAlbedo / pi
    Rgb glossy{0, 0, 0};           ///< reflected besides: GlossyLobe
    Rgb diffuseIndirect{0, 0, 0};  ///< part of `diffuse` that comes from other surfaces
    Rgb glossyIndirect{0, 0, 0};   ///< part of `glossy` that does
    Rgb emission{0, 0, 0};         ///< of surfaces, of lamps that cameras see, and the sky
    Rgb environment{0, 0, 0};      ///< part of `emission` that is the sky
    Rgb predicted{0, 0, 0};        ///< the colour with its diffuse part predicted without rays, if
                                   ///< RenderOptions::preview
    Rgb irradiance{0, 0, 0};
    Rgb albedo{0, 0, 0};         ///< base colour
    Rgb diffuseAlbedo{0, 0, 0};  ///< of the diffuse part
    Rgb mirrorColor{0, 0, 0};    ///< reflectance of the glossy part at normal incidence
    float roughness = 0;
    Vec3f normal{0, 0, 0};  ///< toward the viewer
    Vec3f position{0, 0, 0};
    float depth = 0;       ///< distance from the camera; 0: the sky
    float axialDepth = 0;  ///< its part along the view
    float alpha = 0;       ///< chance that the ray meets the set: less than 1 where it may pass
    float coverage = 0;    ///< 1 where it does
    // What the cache predicts before any ray, if RenderOptions::insight.
    float openness = 0;  ///< visible share of the sky, weighted by the cosine
    float items = 0;     ///< cache items found
    float regions = 0;   ///< regions that samples are drawn from
    float misses = 0;    ///< 1 where the camera ray met the set and found no item

    RayValues& operator+=(const RayValues& other);
    RayValues& operator*=(float factor);
    /// Multiplies what is no light, nor a share of it: from the roughness on, but for alpha.
    void scaleGeometry(float factor);
};

/// What the renderer found at one pixel: the mean of its camera rays, and how sure it is.
struct Pixel : RayValues {
    float variance = 0;    ///< of the irradiance's luminance, from the spread of the camera rays;
                           ///< of one camera ray, from its samples
    float covariance = 0;  ///< of its camera rays' estimates, summed over all pairs
    float colorVariance = 0;   ///< of the colour's luminance: edges, albedo and sky included
    float glossVariance = 0;   ///< of the luminance of glossy, from the samples alone
    float rays = 0;            ///< shadow rays traced
    float reusedRays = 0;      ///< those of them that reuse what other pixels found
    float sampleVariance = 0;  ///< of the luminance of the irradiance over the set, from the
                               ///< samples alone
    float cameraRays = 0;
    float expectedNoise = 0;  ///< standard deviation of the irradiance's luminance that the cache
                              ///< predicts, if RenderOptions::insight
};

/// FilmRays sends its camera rays (film_rays.h), addToFilm() adds what they find (film_sum.h).
struct Film {
    int width = 0;
    int height = 0;
    std::vector<Pixel> pixels;
    int x = 0, y = 0;  ///< of its first pixel in the frame
    int frameWidth = 0, frameHeight = 0;
    bool transparent = false;           ///< RenderOptions::transparent: it has an alpha channel
    std::vector<std::string> groups{};  ///< names of the light groups; empty: none
    GroupedLight groupColors{};         ///< of the pixels: together their colours
};

/// Whether colour, irradiance and variance are finite numbers.
bool isFinite(const Pixel& pixel);

/// Camera rays a pixel, on the mean.
double meanCameraRays(const Film& film);

Image colorImage(const Film& film);

/// Alpha of the pixels of a transparent film; none of another.
std::vector<float> alphaOf(const Film& film);

}  // namespace shadowcache
