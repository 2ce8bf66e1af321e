#pragma once

#include <memory>

#include "common/cache/shadow_cache.h"
#include "common/image/radiance_image.h"

namespace shadowcache {

class Environment;

/// A direction to the light, as seen from a place.
struct LightSample {
    /// Unit, world space. It may lie below the place's horizon, whence no light comes: the sample
    /// counts all the same, for its `control`.
    Vec3f direction{0, 0, 0};
    /// Of the map along it.
    Rgb radiance{0, 0, 0};
    /// Control variate along it [radiance]: about radiance, cosine and cached visibility
    /// multiplied.
    Rgb control{0, 0, 0};
    /// Density with which the place's directions are drawn there [1/sr]. 0: none is drawn there,
    /// and nothing is missed, as `radiance` times cosine is 0.
    double pdf = 0;
};

/// What the density of samples follows.
enum class SampleAim {
    difference,  ///< what the control variate is predicted to leave: for estimates with it
    light        ///< radiance times cosine times cached visibility: for estimates without it
};

/// Directions to the light of an environment map for a renderer that traces the rays itself, at any
/// place of a cached set. Their density is above 0 wherever radiance times cosine is. With the
/// control variate f of integral F, the visibility V that rays find, and n samples w,
///
///     irradiance = F + 1/n sum of (V(w) max(0, cos w) radiance(w) - f(w)) / pdf(w)
///
/// on average, whatever the cache holds; and so without F and f. Immutable, thread-safe.
/// [docs/estimator.md]
class LightSampler {
public:
    /// @param cache            stays open as long as the sampler
    /// @param map              as of IrradiancePredictor. It is copied
    /// @param rotationDegrees  turns the map about +Y, counter-clockwise seen from above
    /// @throws Error for an empty map or one of over 2^31 texels
    LightSampler(const ShadowCache& cache, const RadianceImage& map, double rotationDegrees = 0);
    /// @param environment  stays as long as the sampler, and is not turned
    LightSampler(const ShadowCache& cache, const Environment& environment);
    ~LightSampler();
    LightSampler(const LightSampler&) = delete;
    LightSampler& operator=(const LightSampler&) = delete;

    /// A thread's access, at one place after the other. Results do not depend on earlier places.
    class Reader {
    public:
        /// @param sampler  outlives the reader
        explicit Reader(const LightSampler& sampler);
        ~Reader();
        Reader(Reader&&) noexcept;

        /// Goes to a place; all other functions are about the last one. This is what costs time:
        /// several samples at one place take little more than one.
        ///
        /// @param position  world space
        /// @param normal    unit, towards the side that is lit
        /// @param aim       of the samples to be drawn
        /// @return whether the cache has an item here; without, directions follow light and cosine
        /// @throws Error naming the file if the cache has a memory budget and its file cannot be
        /// read any more
        bool moveTo(const Vec3d& position, const Vec3f& normal,
                    SampleAim aim = SampleAim::difference);

        /// Whether no light reaches the place: pdf() is 0 everywhere, and sample() must not be
        /// called.
        bool empty() const;

        /// F, the integral of the control variate over all directions [radiance sr].
        const Rgb& integral() const;

        /// Draws a direction: a pure function of its arguments, which are in [0, 1). Stratified
        /// numbers make stratified directions, `u` above all.
        ///
        /// @param u     chooses the region of the sky, and the texel of the map in it
        /// @param x, y  the place in the texel
        LightSample sample(double u, float x, float y) const;

        /// What sample() returns where it draws this direction.
        ///
        /// @param direction  any unit vector
        LightSample along(const Vec3f& direction) const;

        /// LightSample::pdf along a unit vector [1/sr]: to weigh other samples against these.
        double pdf(const Vec3f& direction) const { return along(direction).pdf; }

    private:
        struct Impl;
        std::unique_ptr<Impl> impl_;
    };

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace shadowcache
