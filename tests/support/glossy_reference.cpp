#include "tests/support/glossy_reference.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "tests/support/test_scenes.h"

namespace shadowcache::test {

namespace {

double alphaOf(const Gloss& gloss) {
    const auto roughness = static_cast<double>(gloss.roughness);
    return roughness * roughness;
}

double lambda(double alpha, double cosine) {
    const double tangent2 = (1 - cosine * cosine) / (cosine * cosine);
    return (std::sqrt(1 + alpha * alpha * tangent2) - 1) / 2;
}

double distribution(double alpha, double cosine) {
    const double x = cosine * cosine * (alpha * alpha - 1) + 1;
    return alpha * alpha / (kPi * x * x);
}

Vec3d mix(const Vec3d& a, const Vec3d& b, double t) {
    return a * (1 - t) + b * t;
}

/// What one mirror reflects, and the share that is left for the base; dielectric and metal.
struct Fresnel {
    Vec3d dielectric, metal;
    double left;
};

Fresnel fresnel(const GlossyLook& look, double cosine) {
    const double weight = std::pow(1 - std::abs(cosine), 5);
    const auto ior = static_cast<double>(look.gloss.ior),
               specular = static_cast<double>(look.gloss.specular);
    const double f0 = std::pow((ior - 1) / (ior + 1), 2);
    Fresnel result;
    double most = 0;
    for (int k = 0; k < 3; ++k) {
        const double normal =
            std::min(f0 * static_cast<double>(look.gloss.specularColor[k]), 1.0) * specular;
        result.dielectric[k] = normal + (specular - normal) * weight;
        most = std::max(most, result.dielectric[k]);
        const auto base = static_cast<double>(look.baseColor[k]);
        result.metal[k] = base + (1 - base) * weight;
    }
    result.left = 1 - most;
    return result;
}

}  // namespace

std::vector<GlossyLook> glossyLooks() {
    const Rgb gold(0.9f, 0.7f, 0.3f), wood(0.5f, 0.3f, 0.2f);
    return {{wood, {.metallic = 0, .roughness = 0.15f}},
            {gold, {.metallic = 1, .roughness = 0.3f}},
            {wood, {.metallic = 0, .roughness = 0.5f, .ior = 1.8f, .specular = 0.8f}},
            {gold, {.metallic = 0.4f, .roughness = 0.6f, .specularColor = Rgb(1, 3, 0.5f)}},
            {Rgb(1, 1, 1), {.metallic = 1, .roughness = 1}}};
}

Vec3d referenceBrdf(const GlossyLook& look, const Vec3d& n, const Vec3d& toViewer,
                    const Vec3d& toLight) {
    const double alpha = alphaOf(look.gloss);
    const Vec3d h = (toViewer + toLight).normalized();
    const double o = n.dot(toViewer), i = n.dot(toLight);
    const double mirrors =
        distribution(alpha, n.dot(h)) / (1 + lambda(alpha, o) + lambda(alpha, i)) / (4 * o * i);
    const Fresnel f = fresnel(look, toViewer.dot(h));
    const Vec3d dielectric = Vec3d(look.baseColor) * (f.left / kPi) + f.dielectric * mirrors;
    return mix(dielectric, f.metal * mirrors, static_cast<double>(look.gloss.metallic));
}

Vec3d referenceAlbedo(const GlossyLook& look, double cosine) {
    constexpr int kSteps = 1000;
    const double alpha = alphaOf(look.gloss);
    const auto metallic = static_cast<double>(look.gloss.metallic);
    const Vec3d o(std::sqrt(1 - cosine * cosine), 0, cosine);
    Vec3d sum(0.0);
    for (int x = 0; x < kSteps; ++x) {
        // A substitution that makes normals at grazing angles harmless.
        const double s = (x + 0.5) / kSteps, a = s * s;
        const double tangent = alpha * std::sqrt((1 - a) / a);
        const double hz = 1 / std::sqrt(1 + tangent * tangent);
        for (int y = 0; y < kSteps; ++y) {
            const double phi = kPi * (y + 0.5) / kSteps;  // half of them: it is symmetrical
            const double hx = hz * tangent * std::cos(phi);
            const Vec3d h(hx, hz * tangent * std::sin(phi), hz);
            const double facing = o.dot(h);
            const Vec3d i = h * (2 * facing) - o;
            if (facing > 0 && i.z > 0) {
                const double share =
                    facing / (cosine * hz) / (1 + lambda(alpha, cosine) + lambda(alpha, i.z));
                const Fresnel f = fresnel(look, facing);
                sum += mix(f.dielectric, f.metal, metallic) * (share * 2 * s);
            }
            // The base: directions in proportion to the cosine.
            const double r = std::sqrt(s);
            const Vec3d light(r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - s));
            const double half = o.dot((o + light).normalized());
            sum += Vec3d(look.baseColor) * ((1 - metallic) * fresnel(look, half).left);
        }
    }
    return sum / (1.0 * kSteps * kSteps);
}

double visibleNormalProbability(double alpha, double cosine, double a0, double a1, double p0,
                                double p1) {
    constexpr int kSteps = 64;
    const Vec3d o(std::sqrt(1 - cosine * cosine), 0, cosine);
    double sum = 0;
    for (int x = 0; x < kSteps; ++x) {
        const double s = std::sqrt(a0) + (std::sqrt(a1) - std::sqrt(a0)) * (x + 0.5) / kSteps;
        const double tangent = alpha * std::sqrt((1 - s * s) / (s * s));
        for (int y = 0; y < kSteps; ++y) {
            const double phi = 2 * kPi * (p0 + (p1 - p0) * (y + 0.5) / kSteps);
            const double facing = o.x * tangent * std::cos(phi) + o.z;
            sum += std::max(0.0, facing) * 2 * s;
        }
    }
    return sum * (std::sqrt(a1) - std::sqrt(a0)) * (p1 - p0) / (kSteps * kSteps) / cosine /
           (1 + lambda(alpha, cosine));
}

Rgb tracedReflection(const Scene& scene, const ShadingPoint& point, const GlossyLook& look,
                     const Vec3d& toViewer, const Environment& environment) {
    const Vec3d n(point.place.normal);
    Vec3d sum(0.0);
    RayPacket packet{};
    for (std::size_t t = 0; t < environment.texelCount(); ++t) {
        const Environment::Texel texel = environment.texel(t);
        const Vec3d w(texel.center);
        if (!(n.dot(w) > 0)) continue;
        packet.set(0, point.place.rayOrigin, texel.center);
        if (scene.visibility(packet, 1) == 0) continue;
        sum += Vec3d(texel.radiance) * referenceBrdf(look, n, toViewer, w) *
               (n.dot(w) * static_cast<double>(texel.solidAngle));
    }
    return Rgb(sum);
}

std::vector<double> reflectedBySeeds(const Estimator& estimator, const ShadingPoint& point,
                                     const GlossyLobe& lobe, std::uint64_t seeds) {
    const auto workspace = estimator.makeWorkspace();
    std::vector<double> found;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        ShadingPoint seeded = point;
        seeded.slot.seed = hashWords(seed);
        const GlossyPoint glossyPoint{seeded, lobe};
        GlossEstimate estimate;
        const PointBatch batch{.points = std::span(&seeded, 1), .samples = 8};
        estimator.estimateGloss(batch, std::span(&glossyPoint, 1), *workspace,
                                std::span(&estimate, 1));
        found.push_back(static_cast<double>(estimate.radiance.y));
    }
    return found;
}

}  // namespace shadowcache::test
