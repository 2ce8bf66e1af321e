#include "tests/study/estimators/technique_table.h"

#include "common/base/error.h"
#include "common/base/suggestion.h"

namespace shadowcache::study {

namespace {

/// A maker that reads no options, and one that reads its part of them.
template <auto make>
std::unique_ptr<Estimator> plain(const EstimatorContext& context, const TechniqueOptions&) {
    return make(context);
}
template <auto make, auto part>
std::unique_ptr<Estimator> with(const EstimatorContext& context, const TechniqueOptions& options) {
    return make(context, options.*part);
}

}  // namespace

void validate(const TechniqueOptions& options) {
    validate(options.paper);
    validate(options.lights);
    validate(options.pixel);
}

std::vector<Technique> techniques() {
    std::vector<Technique> all;
    for (const EstimatorEntry& entry : estimatorTable())
        if (entry.name != std::string("paper"))
            all.push_back({.name = entry.name,
                           .summary = entry.summary,
                           .needsCache = entry.needsCache,
                           .entry = &entry});
    all.push_back({.name = "paper",
                   .summary = findEstimator("paper").summary,
                   .make = with<makePaperVariant, &TechniqueOptions::paper>});
    all.push_back({.name = "paper-image",
                   .summary = "`paper` with its own cache: filled by the picture's earlier pixels",
                   .inOrder = true,
                   .make = with<makePaperImage, &TechniqueOptions::paper>});
    all.push_back({.name = "pixel",
                   .summary = "importance from a low-resolution map",
                   .make = with<makePixel, &TechniqueOptions::pixel>});
    all.push_back({.name = "pixel-printed",
                   .summary = "`pixel` as the paper prints it",
                   .bias = "pixels whose middle is below the horizon are left out",
                   .make = with<makePixelPrinted, &TechniqueOptions::pixel>});
    all.push_back({.name = "preconvolved",
                   .summary = "the map's irradiance as if nothing occluded it, without rays",
                   .bias = "visibility is left out",
                   .make = plain<makePreconvolved>});
    all.push_back({.name = "ambient-occlusion",
                   .summary = "`preconvolved` times the visible share of the hemisphere, from rays",
                   .bias = "visibility is one number for all directions",
                   .make = plain<makeAmbientOcclusion>});
    all.push_back({.name = "ambient-occlusion-cached",
                   .summary = "the same from the cache, without rays",
                   .needsCache = true,
                   .bias = "visibility is one number for all directions, and cached",
                   .make = plain<makeAmbientOcclusionCached>});
    all.push_back({.name = "lights",
                   .summary = "a finite set of directional lights, one ray each",
                   .bias = "the map is a few directional lights",
                   .make = with<makeLights, &TechniqueOptions::lights>});
    return all;
}

Technique findTechnique(const std::string& name) {
    std::vector<std::string> names;
    std::string known;
    for (const Technique& technique : techniques()) {
        if (technique.name == name) return technique;
        names.push_back(technique.name);
        known += (known.empty() ? "" : ", ") + technique.name;
    }
    throw Error("--estimator " + name + ": expected one of " + known + suggestion(name, names));
}

std::unique_ptr<Estimator> makeEstimator(const std::string& name, const EstimatorContext& context,
                                         const TechniqueOptions& options) {
    const Technique technique = findTechnique(name);
    if (technique.entry) return technique.entry->make(context, {options.cache, options.paper});
    return technique.make(context, options);
}

}  // namespace shadowcache::study
