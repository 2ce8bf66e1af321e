#pragma once

#include <string>

#include "render/table/estimator_table.h"
#include "tests/study/estimators/makers.h"

namespace shadowcache::study {

/// The options of all techniques; each reads its own.
struct TechniqueOptions {
    CacheOptions cache;
    VariantOptions paper;
    PixelOptions pixel;
    LightsOptions lights;
};

/// @throws Error naming the option, the value and the range allowed
void validate(const TechniqueOptions& options);

/// One line of the table of techniques: what the paper compares its method with, and the renderer's
/// estimators.
struct Technique {
    std::string name;
    std::string summary;
    bool needsCache = false;
    std::string bias = "none";  ///< what its expectation leaves out or gets wrong
    /// Whether a pixel depends on those that the same thread lit before: for frames of one thread.
    bool inOrder = false;
    std::unique_ptr<Estimator> (*make)(const EstimatorContext&, const TechniqueOptions&) = nullptr;
    const EstimatorEntry* entry = nullptr;  ///< of the renderer's, in place of `make`
};

std::vector<Technique> techniques();

/// @throws Error naming the techniques there are
Technique findTechnique(const std::string& name);

std::unique_ptr<Estimator> makeEstimator(const std::string& name, const EstimatorContext& context,
                                         const TechniqueOptions& options = {});

}  // namespace shadowcache::study
