#pragma once

#include <array>
#include <cstdint>

#include "render/frame/options.h"

namespace shadowcache {

/// Chooses where around a pixel's centre its camera rays go, with the filter's value as density:
/// all rays then have one weight, and pixels share no ray. [Ernst, Stamminger & Greiner 2006,
/// Filter importance sampling]
///
/// Filters and widths are those of Blender's Cycles: in each axis a box of the width; a Gaussian of
/// standard deviation width / 4, cut at 6 of them; a Blackman-Harris window of twice the width.
class PixelFilter {
public:
    /// @param width  in pixels; 0: 1 for the box, 1.5 for the others
    PixelFilter(FilterKind kind, double width);

    /// Distance from the pixel's centre along one axis, for u in [0, 1). [pixels]
    double offset(double u) const;

    /// Nothing is farther from the centre. [pixels]
    double radius() const { return radius_; }

private:
    static constexpr std::size_t kSteps = 1024;

    bool box_;
    double radius_;
    std::array<double, kSteps + 1> cdf_{};  ///< of |offset| at radius * i / kSteps
    /// Where in cdf_ a search for i / kSteps begins: the first above it.
    std::array<std::uint16_t, kSteps> guide_{};
};

/// Value of a filter at a distance along one axis, to any scale; 0 beyond its radius.
double filterValue(FilterKind kind, double width, double distance);

}  // namespace shadowcache
