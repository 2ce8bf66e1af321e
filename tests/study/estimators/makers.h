#pragma once

#include "render/paper/paper_estimators.h"

namespace shadowcache::study {

/// Of the paper's method.
struct VariantOptions : PaperOptions {
    int order = 0;                  ///< importance in a triangle constant (0) or linear (1)
    bool exactConvolution = false;  ///< convolutions at the normal itself, no tables
};

struct PixelOptions {
    int width = 200;  ///< of the low-resolution map, 8x4 .. 4096x2048
    int height = 100;
};

struct LightsOptions {
    int lights = 40;  ///< K, 1 .. 10000
};

/// @throws Error naming the option, the value and the range allowed
void validate(const VariantOptions& options);
void validate(const PixelOptions& options);
void validate(const LightsOptions& options);

// One maker an estimator; each is defined in the estimator's own file.
std::unique_ptr<Estimator> makePaperVariant(const EstimatorContext& context,
                                            const VariantOptions& options);
std::unique_ptr<Estimator> makePaperImage(const EstimatorContext& context,
                                          const VariantOptions& options);
std::unique_ptr<Estimator> makePixel(const EstimatorContext& context, const PixelOptions& options);
std::unique_ptr<Estimator> makePixelPrinted(const EstimatorContext& context,
                                            const PixelOptions& options);
std::unique_ptr<Estimator> makePreconvolved(const EstimatorContext& context);
std::unique_ptr<Estimator> makeAmbientOcclusion(const EstimatorContext& context);
std::unique_ptr<Estimator> makeAmbientOcclusionCached(const EstimatorContext& context);
std::unique_ptr<Estimator> makeLights(const EstimatorContext& context,
                                      const LightsOptions& options);

}  // namespace shadowcache::study
