#pragma once

#include <memory>

#include "render/estimators/emitter_light.h"
#include "render/estimators/estimator.h"

namespace shadowcache {

/// Wraps an estimator of the light of a sky: adds the direct light of the set's own emitters.
///
/// @param sky       of the environment alone
/// @param emitters  outlives the estimator
std::unique_ptr<Estimator> withEmitters(std::unique_ptr<Estimator> sky,
                                        const EmitterLight& emitters);

}  // namespace shadowcache
