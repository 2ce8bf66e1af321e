#include "render/table/estimator_table.h"

#include <vector>

#include "common/base/error.h"
#include "common/base/suggestion.h"
#include "render/estimators/lit_estimator.h"

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
     false, with<makePaper, &EstimatorOptions::paper>, false},
    {"cache", "cached visibility as a control variate (needs --cache; the default with one)", 0,
     true, with<makeCacheEstimator, &EstimatorOptions::cache>},
};

}  // namespace

std::unique_ptr<Estimator> EstimatorEntry::make(const EstimatorContext& context,
                                                const EstimatorOptions& options) const {
    std::unique_ptr<Estimator> sky = maker(context, options);
    return context.emitters ? withEmitters(std::move(sky), *context.emitters) : std::move(sky);
}

std::span<const EstimatorEntry> estimatorTable() {
    return kEstimators;
}

std::string biasOf(int samples) {
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
