#pragma once

#include <optional>
#include <span>
#include <vector>

#include "render/frame/frame_request.h"
#include "render/frame/pixel_filter.h"
#include "render/frame/ray_batch.h"

namespace shadowcache {

/// Sends camera rays through the film of a frame, which outlives this object.
class FilmRays {
public:
    explicit FilmRays(const FrameRequest& frame);

    /// What the middle of the lens sees through a place of the film.
    FilmRay look(const FilmPosition& at) const;

    /// The place of the film through which the middle of the lens sees a point, relative to the
    /// set's origin; nothing if that is not in front of it.
    std::optional<FilmPosition> project(const Vec3f& point) const;

    /// Sends the camera rays of a batch, in the order of pixels and of rays in a pixel.
    std::vector<FilmRay> cast(const BatchPixels& batch) const;

    /// Sends camera rays 0 to `count - 1` of each of some pixels; they are none of the picture's.
    std::vector<FilmRay> castExtra(std::span<const FilmPlace> places, int count) const;

    /// Sends emission rays of a pixel: they show what its camera rays do, but what emits alone
    /// counts.
    std::vector<FilmRay> castEmission(const FilmPlace& place, RayRange range) const;

private:
    /// Adds camera rays of a pixel, `pixel` in its batch, to `rays`.
    void aim(const FilmPlace& place, std::uint32_t pixel, std::uint64_t seed, RayRange range,
             std::vector<FilmRay>& rays) const;
    /// Finds what rays meet.
    ///
    /// @param leastOfPanes  as Scene::look() has it
    void intersect(std::span<FilmRay> rays, float leastOfPanes) const;

    const Scene& scene_;
    const CameraRays camera_;
    const int number_;
    const RenderOptions& options_;
    const PixelFilter filter_;
    const float leastOfPanes_;
};

}  // namespace shadowcache
