#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "render/frame/antialiasing.h"
#include "render/frame/film_rays.h"

namespace shadowcache {

/// What emitters cover of the pixels of a frame. Few camera rays meet those that are thinner than a
/// pixel, or hidden but for a gap, so that spreads predicted by a few rays alone would miss most.
class VisibleEmitters {
public:
    /// Looks for them by rays from the middle of the lens to points of them: some for each pixel of
    /// their length and area, and about one for each pixel of the frame at most.
    explicit VisibleEmitters(const FrameRequest& frame);

    /// Adds their luminance to a pixel's, as if its camera rays had seen their share of them, where
    /// that makes what they see differ more.
    void addTo(const FilmPlace& pixel, PredictedSpread& spread) const;

    /// Rays that were sent.
    std::uint64_t rays() const { return rays_; }

private:
    struct Seen {
        double luminance = 0, square = 0;  ///< integrals over the pixel
    };
    std::map<std::pair<int, int>, Seen> seen_;  ///< by pixel: x and y
    std::uint64_t rays_ = 0;
};

}  // namespace shadowcache
