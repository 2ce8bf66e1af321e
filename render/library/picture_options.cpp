#include "render/library/picture_options.h"

#include <fmt/core.h>

#include "common/base/error.h"
#include "render/frame/aov_channels.h"

namespace shadowcache {

namespace {

bool sameGloss(const std::optional<Gloss>& a, const std::optional<Gloss>& b) {
    if (!a || !b) return !a && !b;
    return a->metallic == b->metallic && a->roughness == b->roughness && a->ior == b->ior &&
           a->specular == b->specular && a->specularColor == b->specularColor;
}

}  // namespace

std::string biasOf(const PictureSettings& settings) {
    const RenderOptions& options = settings.options;
    if (options.preview) return "preview: what rays add to the prediction is filtered";
    if (options.bounces != 0 && options.clampIndirect > 0)
        return "clamp-indirect: bright light that bounces is cut";
    return biasOf(options.samples);
}

PictureSettings resolve(const PictureOptions& asked, bool hasCache, bool gloss) {
    const EstimatorEntry& estimator =
        findEstimator(asked.estimator.value_or(hasCache ? "cache" : "mis"));
    PictureSettings settings{estimator, asked.options};
    RenderOptions& options = settings.options;
    chooseRays(asked.rays, estimator, options);
    options.bounces = asked.bounces.value_or(kStandardBounces);
    for (const std::string& aov : asked.aovs) {
        if (needsInsight(aov) && !estimator.needsCache)
            throw Error(fmt::format("--aov {}: requires --estimator cache", aov));
        options.insight = options.insight || needsInsight(aov);
    }
    if (options.plain.gloss && !gloss)
        throw Error(
            "--material makes surfaces glossy, --surfaces diffuse leaves gloss out: "
            "expected one of them");
    if (!asked.groups.empty() && options.preview && options.samples > 0)
        throw Error(
            "--light-groups with --preview: what rays add is filtered for all groups together; "
            "expected --spp 0, or no --preview");
    validate(options);
    requireFit(estimator, hasCache, options);
    return settings;
}

LightingOptions lightingOf(const PictureOptions& asked, const PictureSettings& settings) {
    return {asked.estimators, asked.sequence, settings.options.bounces, settings.options.plain,
            asked.groups};
}

bool isSame(const LightingOptions& a, const LightingOptions& b) {
    return a.estimator.cache.adaptive == b.estimator.cache.adaptive && a.sequence == b.sequence &&
           a.bounces == b.bounces && a.plain.albedo == b.plain.albedo &&
           sameGloss(a.plain.gloss, b.plain.gloss) && a.groups == b.groups;
}

}  // namespace shadowcache
