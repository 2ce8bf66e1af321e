#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/library/pixel_rays.h"

namespace shadowcache {

/// What a picture is asked for, before it is known whether there is a cache.
struct Wanted {
    std::optional<std::string> estimator{};  ///< none: `cache` with a cache, `mis` without
    PixelRays rays{};
    std::optional<int> bounces{};  ///< none: kStandardBounces
    std::vector<std::string> aovs{};
    RenderOptions options{};
};

/// The estimator and the options of a picture.
struct Chosen {
    const EstimatorEntry& estimator;
    RenderOptions options;
};

/// @throws Error naming what is out of range, or does not fit the estimator or the cache
Chosen choose(const Wanted& wanted, bool hasCache);

/// A number of bounces, or "unlimited". @throws Error naming what is expected
int parseBounces(const std::string& text);

}  // namespace shadowcache
