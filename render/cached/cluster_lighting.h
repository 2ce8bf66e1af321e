#pragma once

#include <span>

#include "render/cached/cluster_sampler.h"
#include "render/cached/cosine_integrand.h"
#include "render/cached/sample_tracer.h"

namespace shadowcache {

/// Traces the samples of a cluster: adds to the points' estimates what they find beyond the control
/// variate, and hands mispredictions on to be reused.
void traceCluster(const EstimatorContext& context, const PointBatch& batch,
                  const FittedRegions<CosineIntegrand>& fitted, const SamplingPlan& plan,
                  std::span<const ClusterSample> samples, SampleTracer::Run& run);

}  // namespace shadowcache
