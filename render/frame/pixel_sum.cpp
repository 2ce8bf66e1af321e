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

void EmissionSum::add(const SeenEmission& seen, const SpreadRule& rule) {
    emission += seen.sum();
    environment += seen.sky;
    spread.add(rule.luminance(seen.sum()), runLength(rule));
    ++rays;
}

void EmissionSum::addTo(Pixel& pixel, const SpreadRule& rule) const {
    if (rays == 0) return;
    const float scale = 1.0f / static_cast<float>(rays);
    for (Rgb* sum : {&pixel.color, &pixel.predicted, &pixel.emission}) *sum += emission * scale;
    pixel.environment += environment * scale;
    pixel.colorVariance += static_cast<float>(spread.varianceOfMean(runLength(rule), rays));
}

void PixelSum::addSky(const SeenEmission& seen, const Hit& hit, const SpreadRule& rule) {
    const Rgb radiance = seen.sum();
    values += {.color = radiance,
               .emission = radiance,
               .environment = seen.sky,
               .predicted = radiance,
               .alpha = hit.covered};
    color.add(rule.luminance(radiance), rule.runLength);
    irradiance.add(0, rule.runLength);
    ++cameraRays;
    shares += hit.share;
}

void PixelSum::addHit(const RayValues& ray, const Estimate& estimate, const GlossEstimate& gloss,
                      const SpreadRule& rule) {
    values += ray;
    color.add(rule.luminance(ray.color), rule.runLength);
    irradiance.add(rule.luminance(ray.irradiance), rule.runLength);
    ++cameraRays;
    shares += ray.coverage;
    const float squared = ray.coverage * ray.coverage;
    variance += estimate.variance * squared;
    // As if what shares rays counted alike.
    covariance += estimate.covariance * squared;
    glossVariance += gloss.variance;
    rays += static_cast<float>(estimate.rays + estimate.reused + gloss.rays);
    reusedRays += static_cast<float>(estimate.reused);
}

Pixel PixelSum::average(const SpreadRule& rule) const {
    const float scale = 1.0f / static_cast<float>(std::max(1, cameraRays));
    // Camera rays that meet the set, by their shares.
    const float ofHits = values.coverage > 0 ? values.coverage : 1;
    Pixel pixel{values};
    pixel *= scale;
    if (shares > 0) pixel.scaleGeometry(static_cast<float>(cameraRays) / shares);
    // Errors of camera rays are independent.
    pixel.expectedNoise = std::sqrt(expectedVariance) * scale;
    pixel.cameraRays = static_cast<float>(cameraRays);
    pixel.rays = rays;
    pixel.reusedRays = reusedRays;
    pixel.covariance = covariance;
    pixel.glossVariance = glossVariance;
    pixel.sampleVariance = (variance + covariance) / (ofHits * ofHits);
    const double reflectance = rule.luminance(pixel.diffuseAlbedo) / kPi;
    if (cameraRays < 2) {
        pixel.variance = variance;
        pixel.colorVariance =
            static_cast<float>(reflectance * reflectance * static_cast<double>(variance)) +
            glossVariance;
    } else {
        // What values have in common widens their mean, and narrows their spread.
        const double count = cameraRays;
        const double common = static_cast<double>(covariance) / (count * (count - 1));
        const double perHit = reflectance * count / static_cast<double>(ofHits);
        const auto spreadWith = [&](const RunSpread& spread, double shared) {
            return static_cast<float>(
                std::max(0.0, spread.varianceOfMean(rule.runLength, cameraRays) + shared));
        };
        pixel.variance = spreadWith(irradiance, common);
        pixel.colorVariance = spreadWith(color, perHit * perHit * common);
    }
    apart.addTo(pixel, rule);
    return pixel;
}

}  // namespace shadowcache
