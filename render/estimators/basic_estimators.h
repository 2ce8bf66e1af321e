#pragma once

#include "render/estimators/estimator.h"

namespace shadowcache {

// One maker an estimator; each is defined in the estimator's own file.
std::unique_ptr<Estimator> makeUniform(const EstimatorContext& context);
std::unique_ptr<Estimator> makeCosine(const EstimatorContext& context);
std::unique_ptr<Estimator> makeEnvironment(const EstimatorContext& context);
std::unique_ptr<Estimator> makeMis(const EstimatorContext& context);
std::unique_ptr<Estimator> makeDome(const EstimatorContext& context);

}  // namespace shadowcache
