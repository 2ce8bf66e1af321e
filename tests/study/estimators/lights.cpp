// A finite set of directional lights in place of the map: no noise, but bands at the borders of
// shadows. Biased. [paper 3.1]

#include "common/base/option_checks.h"
#include "tests/study/estimators/light_clusters.h"
#include "tests/study/estimators/makers.h"

namespace shadowcache::study {

namespace {

class Lights final : public PointEstimator {
public:
    Lights(const EstimatorContext& context, const LightsOptions& options)
        : PointEstimator(context), lights_(clusterLights(context.environment, options.lights)) {}

private:
    std::vector<DirectionalLight> lights_;

    Rgb prepare(const ShadingPoint& point, const SampleSlice&, Workspace& w) const override {
        for (const DirectionalLight& light : lights_) {
            const float cosine = light.direction.dot(point.place.normal);
            if (cosine <= 0) continue;
            w.samples.add(light.direction, light.radianceIntegral * cosine);
            w.samples.endGroup();
        }
        return {0, 0, 0};
    }
};

}  // namespace

void validate(const LightsOptions& options) {
    requireRange("lights", options.lights, 1, 10000);
}

std::unique_ptr<Estimator> makeLights(const EstimatorContext& context,
                                      const LightsOptions& options) {
    return std::make_unique<Lights>(context, options);
}

}  // namespace shadowcache::study
