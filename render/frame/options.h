#pragma once

#include <cstdint>
#include <optional>

#include "common/base/named.h"
#include "common/mesh/looks.h"
#include "render/bounces/bounce_task.h"

namespace shadowcache {

inline constexpr int kMostSamples = 1 << 20;
inline constexpr int kMostCameraRays = 65536;

/// How the light that reaches a pixel is weighted around its centre.
enum class FilterKind { box, gaussian, blackmanHarris };

/// Names accepted by --filter.
inline constexpr Named<FilterKind> kFilters[] = {{"box", FilterKind::box},
                                                 {"gaussian", FilterKind::gaussian},
                                                 {"blackman-harris", FilterKind::blackmanHarris}};

/// Pixels of a film; x and y are those of the upper left one.
struct FilmRectangle {
    int x = 0, y = 0, width = 0, height = 0;
};

/// Options of a picture: values alone. Their names, ranges and help are rows of
/// render/library/option_table.cpp.
struct RenderOptions {
    int width = 960;
    int height = 540;
    int samples = 64;    ///< shadow rays a camera ray
    int cameraRays = 1;  ///< asked for a pixel; one goes through the pixel's centre
    int passRays = 64;   ///< of them those that are lit together, at most
    FilterKind filter = FilterKind::blackmanHarris;
    double filterWidth = 0;             ///< in pixels; 0: 1 for the box, 1.5 for the others
    std::optional<FilmRectangle> crop;  ///< the part of the frame to render; none: all of it
    int bounces = 0;            ///< surfaces that light may meet before the one that is seen;
                                ///< kUnlimitedBounces: any number
    float clampIndirect = 0;    ///< BounceOptions::clamp
    bool sharedBounces = true;  ///< BounceOptions::shared
    std::uint64_t seed = 1;
    bool transparent = false;  ///< the sky lights the set, but is not seen
    bool preview = false;      ///< filter what the samples add to the prediction: biased
    bool insight =
        false;          ///< keep what the cache predicts at each place, for the AOVs that show it
    PlainLook plain{};  ///< of what has no material and no vertex colours

    /// What is rendered of the frame.
    FilmRectangle region() const { return crop.value_or(FilmRectangle{0, 0, width, height}); }
};

/// @throws Error naming the option, the value and the range allowed
void validate(const RenderOptions& options);

}  // namespace shadowcache
