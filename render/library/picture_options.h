#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/library/lit_stage.h"
#include "render/library/pixel_rays.h"

namespace shadowcache {

/// What a picture is asked for, before it is known whether there is a cache.
struct PictureOptions {
    std::optional<std::string> estimator{};  ///< none: `cache` with a cache, `mis` without
    EstimatorOptions estimators{};           ///< of all of them
    Sequence sequence = Sequence::kSobol;
    PixelRays rays{};
    std::optional<int> bounces{};  ///< none: kStandardBounces
    std::vector<std::string> aovs{};
    std::vector<LightGroupRule> groups{};
    RenderOptions options{};
};

/// The estimator and the options of a picture.
struct PictureSettings {
    const EstimatorEntry& estimator;
    RenderOptions options;
};

/// How the pictures are biased: "none", or the cause.
std::string biasOf(const PictureSettings& settings);

/// The estimator and the options that a picture gets.
///
/// @param gloss  whether the set's materials are glossy (MeshOptions::gloss)
/// @throws Error naming what is out of range, or does not fit the estimator, the set or the cache
PictureSettings resolve(const PictureOptions& asked, bool hasCache, bool gloss = true);

/// How a stage is lit for such pictures.
LightingOptions lightingOf(const PictureOptions& asked, const PictureSettings& settings);

/// Whether a stage that is lit so looks the same, but for options of the paper's estimator.
bool isSame(const LightingOptions& a, const LightingOptions& b);

}  // namespace shadowcache
