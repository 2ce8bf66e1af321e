#include "render/table/estimator_table.h"

#include <vector>

#include "common/base/error.h"
#include "common/base/suggestion.h"

namespace shadowcache {

namespace {

/// A maker that reads no options, and one that reads its part of them.
template <auto make>
std::unique_ptr<Estimator> plain(const EstimatorContext& context, const EstimatorOptions&) {
    return make(context);
}
template <auto make, auto part>
std::unique_ptr<Estimator> with(const EstimatorContext& context, const EstimatorOptions& options) {
    return make(context, options.*part);
}

constexpr EstimatorEntry kEstimators[] = {
    {"uniform", "directions uniform over the hemisphere", 1, false, plain<makeUniform>},
    {"cosine", "directions in proportion to the cosine", 1, false, plain<makeCosine>},
    {"environment", "directions in proportion to the map's luminance", 1, false,
     plain<makeEnvironment>},
    {"mis", "half environment, half cosine, balance heuristic", 1, false, plain<makeMis>},
    {"dome", "`mis` with tiles of the map chosen by what a pilot learned of their visibility", 1,
     false, plain<makeDome>},
    {"paper", "piecewise-constant importance over a triangulated map, times cached visibility", 1,
     false, with<makePaper, &EstimatorOptions::paper>},
    {"paper-image", "`paper` with its own cache: filled by the picture's earlier pixels", 1, false,
     with<makePaperImage, &EstimatorOptions::paper>, nullptr, true},
    {"pixel", "importance from a low-resolution map", 1, false,
     with<makePixel, &EstimatorOptions::pixel>},
    {"cache", "cached visibility as a control variate (needs --cache; the default with one)", 0,
     true, with<makeCache, &EstimatorOptions::cache>},
    {"pixel-printed", "`pixel` as the paper prints it", 1, false,
     with<makePixelPrinted, &EstimatorOptions::pixel>,
     "pixels whose middle is below the horizon are left out"},
    {"preconvolved", "the map's irradiance as if nothing occluded it, without rays", 0, false,
     plain<makePreconvolved>, "visibility is left out"},
    {"ambient-occlusion", "`preconvolved` times the visible share of the hemisphere, from rays", 1,
     false, plain<makeAmbientOcclusion>, "visibility is one number for all directions"},
    {"ambient-occlusion-cached", "the same from the cache, without rays", 0, true,
     plain<makeAmbientOcclusionCached>, "visibility is one number for all directions, and cached"},
    {"lights", "a finite set of directional lights, one ray each", 0, false,
     with<makeLights, &EstimatorOptions::lights>, "the map is a few directional lights"},
};

}  // namespace

void validate(const EstimatorOptions& options) {
    validate(options.paper);
    validate(options.lights);
    validate(options.pixel);
}

std::span<const EstimatorEntry> estimatorTable() {
    return kEstimators;
}

std::string biasOf(const EstimatorEntry& entry, int samples) {
    if (entry.bias) return entry.bias;
    return samples > 0 ? "none" : "no rays: what the cache gets wrong stays";
}

const EstimatorEntry& findEstimator(const std::string& name) {
    std::vector<std::string> names;
    std::string known;
    for (const EstimatorEntry& entry : kEstimators) {
        if (name == entry.name) return entry;
        names.emplace_back(entry.name);
        known += (known.empty() ? "" : ", ") + names.back();
    }
    throw Error("--estimator " + name + ": expected one of " + known + suggestion(name, names));
}

}  // namespace shadowcache
