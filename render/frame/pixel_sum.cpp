#include "render/frame/pixel_sum.h"

#include <algorithm>
#include <cmath>

namespace shadowcache {

double RunSpread::varianceOfMean(int runLength, int count) const {
    if (runs_ < 2) return 0;
    const double mean = sum_ / runs_;
    const double ofRun = std::max(0.0, squares_ - sum_ * mean) / (runs_ - 1);
    // A run's sum has `runLength` values: ofRun / (runLength^2 runs) is of the mean of all in runs.
    return ofRun / (static_cast<double>(runLength) * count);
}

int spreadRunLength(int passRays) {
    int length = 1;
    while (4 * length * length <= passRays) length *= 2;
    return length;
}

Pixel averageOf(const PixelSum& sum, int runLength, const Rgb& luminanceWeights) {
    Pixel pixel = sum.sum;
    const float scale = 1.0f / static_cast<float>(std::max(1, sum.cameraRays));
    pixel.color *= scale;
    pixel.diffuse *= scale;
    pixel.glossy *= scale;
    pixel.diffuseIndirect *= scale;
    pixel.glossyIndirect *= scale;
    pixel.emission *= scale;
    pixel.environment *= scale;
    pixel.predicted *= scale;
    pixel.irradiance *= scale;
    pixel.albedo *= scale;
    pixel.diffuseAlbedo *= scale;
    pixel.mirrorColor *= scale;
    pixel.roughness *= scale;
    pixel.normal *= scale;
    pixel.position *= scale;
    pixel.depth *= scale;
    pixel.axialDepth *= scale;
    pixel.openness *= scale;
    // Errors of camera rays are independent.
    pixel.expectedNoise = std::sqrt(sum.expectedVariance) * scale;
    pixel.items *= scale;
    pixel.regions *= scale;
    pixel.misses *= scale;
    pixel.cameraRays = static_cast<float>(sum.cameraRays);
    pixel.coverage = static_cast<float>(sum.hits) * scale;
    const auto hits = static_cast<float>(std::max(1, sum.hits));
    pixel.sampleVariance = (sum.sum.variance + sum.sum.covariance) / (hits * hits);
    const double reflectance = static_cast<double>(pixel.diffuseAlbedo.dot(luminanceWeights)) / kPi;
    if (sum.cameraRays < 2) {
        pixel.colorVariance =
            static_cast<float>(reflectance * reflectance * static_cast<double>(pixel.variance)) +
            pixel.glossVariance;
    } else {
        // What values have in common widens their mean, and narrows their spread.
        const double rays = sum.cameraRays;
        const double common = static_cast<double>(sum.sum.covariance) / (rays * (rays - 1));
        const double ofHits = reflectance * rays / static_cast<double>(hits);
        const auto variance = [&](const RunSpread& spread, double shared) {
            return static_cast<float>(
                std::max(0.0, spread.varianceOfMean(runLength, sum.cameraRays) + shared));
        };
        pixel.variance = variance(sum.irradiance, common);
        pixel.colorVariance = variance(sum.color, ofHits * ofHits * common);
    }
    return pixel;
}

}  // namespace shadowcache
