#pragma once

#include <optional>

#include "common/shot/camera.h"

namespace shadowcache {

/// A place on the film.
struct FilmPosition {
    double x;  ///< 0 at the picture's left, 1 at its right
    double y;  ///< 0 at the top, 1 at the bottom
};

/// Where a ray leaves the lens, and when.
struct LensSample {
    double u, v;  ///< in [0, 1): uniform over the aperture
    double time;  ///< in [0, 1): of the exposure
};

/// A ray of a camera.
struct CameraRay {
    Vec3d start;      ///< on the near plane
    Vec3d direction;  ///< unit
    double cosine;    ///< of the angle to the view
    double skipped;   ///< from the lens to `start`
    double reach;     ///< from `start` to the far plane; below 0: it meets nothing
};

/// The rays of a camera through its film: what they share is computed once.
class CameraRays {
public:
    /// @param aspect  width / height of the film, in pixels
    /// @throws Error as between() does
    CameraRays(const CameraMove& move, double aspect);

    /// Whether rays through one place of the film differ: by the lens, or by time.
    bool spread() const { return move_.moves || move_.open.lens.radius > 0; }

    /// The ray through a place of the film and the middle of the lens, in the middle of the
    /// exposure.
    CameraRay through(const FilmPosition& at) const noexcept { return middle_.through(at); }

    /// The place of the film whose ray through() meets a point; nothing if that is not in front of
    /// the near plane. Places outside the film are below 0 or above 1.
    std::optional<FilmPosition> project(const Vec3d& point) const noexcept {
        return middle_.project(point);
    }

    /// One of the rays that meet there: over uniform samples they make the picture of a thin lens
    /// [Cook et al. 1984].
    CameraRay through(const FilmPosition& at, const LensSample& sample) const noexcept;

private:
    /// A camera that stands still.
    class Still {
    public:
        Still(const Camera& camera, double aspect) noexcept;
        CameraRay through(const FilmPosition& at) const noexcept;
        CameraRay through(const FilmPosition& at, const LensSample& sample) const noexcept;
        std::optional<FilmPosition> project(const Vec3d& point) const noexcept;

    private:
        CameraRay clipped(const Vec3d& start, const Vec3d& direction) const noexcept;

        Camera camera_;
        double aspect_, tangent_;
        Vec3d right_;
    };

    CameraMove move_;
    double aspect_;
    Still middle_;
};

}  // namespace shadowcache
