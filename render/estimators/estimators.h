#pragma once

#include "render/estimators/estimator.h"

namespace shadowcache {

// One maker an estimator; each is defined in the estimator's own file.
std::unique_ptr<Estimator> makeUniform(const EstimatorContext& context);
std::unique_ptr<Estimator> makeCosine(const EstimatorContext& context);
std::unique_ptr<Estimator> makeEnvironment(const EstimatorContext& context);
std::unique_ptr<Estimator> makeMis(const EstimatorContext& context);
std::unique_ptr<Estimator> makePaper(const EstimatorContext& context);
std::unique_ptr<Estimator> makePaperImage(const EstimatorContext& context);
std::unique_ptr<Estimator> makePixel(const EstimatorContext& context);
std::unique_ptr<Estimator> makePixelPrinted(const EstimatorContext& context);
std::unique_ptr<Estimator> makePreconvolved(const EstimatorContext& context);
std::unique_ptr<Estimator> makeAmbientOcclusion(const EstimatorContext& context);
std::unique_ptr<Estimator> makeAmbientOcclusionCached(const EstimatorContext& context);
std::unique_ptr<Estimator> makeLights(const EstimatorContext& context);
std::unique_ptr<Estimator> makeCache(const EstimatorContext& context);

}  // namespace shadowcache
