#pragma once

#include <memory>
#include <optional>

#include "common/cache/shadow_cache.h"
#include "common/image/radiance_image.h"

namespace shadowcache {

/// Predicts, without tracing rays, the irradiance of an environment map on the surfaces of a cached
/// set. The prediction is the expectation of the cache alone: biased where its counts are wrong,
/// and free of noise. Immutable, thread-safe.
class IrradiancePredictor {
public:
    /// @param cache            stays open as long as the predictor
    /// @param map              lat-long radiance, not empty, finite and non-negative: what
    ///                         readRadiance() returns. +Y is up and row 0; the middle of the image
    ///                         looks to +Z. It is copied
    /// @param rotationDegrees  turns the map about +Y, counter-clockwise seen from above
    /// @throws Error for an empty map or one of over 2^31 texels
    IrradiancePredictor(const ShadowCache& cache, const RadianceImage& map,
                        double rotationDegrees = 0);
    ~IrradiancePredictor();
    IrradiancePredictor(const IrradiancePredictor&) = delete;
    IrradiancePredictor& operator=(const IrradiancePredictor&) = delete;

    /// A thread's access; keeps sums over the items that it met last. The results do not depend on
    /// the order of the calls. One Reader a thread.
    class Reader {
    public:
        /// @param predictor  outlives the reader
        explicit Reader(const IrradiancePredictor& predictor);
        ~Reader();
        Reader(Reader&&) noexcept;

        /// Irradiance on a surface at a place [the map's radiance times sr]: the integral of
        /// radiance, predicted visibility and max(0, cosine) over all directions. Times albedo / pi
        /// it is the radiance that a Lambertian surface reflects.
        ///
        /// @param position  world space
        /// @param normal    unit, towards the side that is lit
        /// @return no value where the cache has no item for the place
        /// @throws Error naming the file if the cache has a memory budget and its file cannot be
        /// read any more
        std::optional<Rgb> irradiance(const Vec3d& position, const Vec3f& normal);

    private:
        struct Impl;
        std::unique_ptr<Impl> impl_;
    };

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace shadowcache
