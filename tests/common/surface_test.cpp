// The metallic-roughness BRDF against its specification, and the directions drawn for it.

#include "common/surface/surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "common/random/sequence.h"
#include "tests/support/glossy_reference.h"
#include "tests/support/statistics.h"

namespace shadowcache {
namespace {

using test::GlossyLook;

/// Unit vector above the horizon of `n`, by number.
Vec3d someDirection(const Vec3d& n, std::uint64_t number) {
    Vec3d s, t;
    tangentFrame(n, s, t);
    const double z = 0.02 + 0.98 * toUnit(hashWords(number, 1)),
                 phi = 2 * kPi * toUnit(hashWords(number, 2));
    const double r = std::sqrt(1 - z * z);
    return (s * (r * std::cos(phi)) + t * (r * std::sin(phi)) + n * z).normalized();
}

/// The product's BRDF, both of its parts.
Vec3d brdf(const GlossyLook& look, const Vec3d& n, const Vec3d& toViewer, const Vec3d& toLight) {
    const Surface surface = glossy(look.baseColor, look.gloss);
    const GlossyLobe lobe(surface, Vec3f(n), Vec3f(toViewer));
    const Rgb diffuse = diffuseAlbedo(surface, static_cast<float>(n.dot(toViewer)));
    return Vec3d(diffuse) / kPi + Vec3d(lobe.value(Vec3f(toLight))) / n.dot(toLight);
}

double difference(const Vec3d& a, const Vec3d& b) {
    return (a - b).length() / (a.length() + b.length());
}

/// Greatest relative difference between the two over many directions.
double greatestDifference(const GlossyLook& product, const GlossyLook& reference) {
    const Vec3d n = Vec3d(0.3, -0.5, 0.8).normalized();
    double greatest = 0;
    for (std::uint64_t k = 0; k < 20000; ++k) {
        const Vec3d o = someDirection(n, 2 * k);
        // Every other direction is near the mirror's.
        const Vec3d mirror = n * (2 * n.dot(o)) - o;
        Vec3d i = someDirection(n, 2 * k + 1);
        if (k % 2 == 0) i = (mirror + i * 0.1).normalized();
        greatest = std::max(
            greatest, difference(brdf(product, n, o, i), test::referenceBrdf(reference, n, o, i)));
    }
    return greatest;
}

TEST(Surface, IsTheSpecifications) {
    for (const GlossyLook& look : test::glossyLooks()) {
        SCOPED_TRACE(look.gloss.roughness);
        EXPECT_LT(greatestDifference(look, look), 2e-4);
        // Control: a little rougher.
        GlossyLook rougher = look;
        rougher.gloss.roughness *= 1.005f;
        EXPECT_GT(greatestDifference(look, rougher), 2e-3);
    }
}

TEST(Surface, IsReciprocal) {
    const Vec3d n = Vec3d(0.3, -0.5, 0.8).normalized();
    for (const GlossyLook& look : test::glossyLooks())
        for (std::uint64_t k = 0; k < 2000; ++k) {
            const Vec3d o = someDirection(n, 2 * k), i = someDirection(n, 2 * k + 1);
            EXPECT_LT(difference(brdf(look, n, o, i), brdf(look, n, i, o)), 2e-4);
        }
}

TEST(Surface, WithoutMirrorsIsLambertian) {
    const Surface chalk = lambertian(Rgb(0.2f, 0.4f, 0.6f));
    EXPECT_FALSE(chalk.glossy);
    EXPECT_EQ(diffuseAlbedo(chalk, 0.1f), Rgb(0.2f, 0.4f, 0.6f));
    // A glossy one whose mirrors reflect nothing is the same.
    const Surface dull = glossy(Rgb(0.2f, 0.4f, 0.6f), {.roughness = 0.3f, .specular = 0});
    EXPECT_EQ(diffuseAlbedo(dull, 0.1f), Rgb(0.2f, 0.4f, 0.6f));
    const GlossyLobe lobe(dull, Vec3f(0, 0, 1), Vec3f(0, 0, 1));
    EXPECT_EQ(lobe.value(Vec3f(0, 0.6f, 0.8f)), Rgb(0.0f));
}

TEST(Surface, ReflectsNothingFromBelow) {
    for (const GlossyLook& look : test::glossyLooks()) {
        const GlossyLobe lobe(glossy(look.baseColor, look.gloss), Vec3f(0, 0, 1),
                              Vec3f(0.8f, 0, 0.6f));
        EXPECT_EQ(lobe.value(Vec3f(0.6f, 0, -0.8f)), Rgb(0.0f));
        EXPECT_EQ(lobe.value(Vec3f(1, 0, 0)), Rgb(0.0f));
    }
}

// Everything stays finite for mirrors, viewers at the horizon and behind it.
TEST(Surface, IsFiniteAtTheExtremes) {
    const Vec3f n(0, 0, 1);
    for (const float roughness : {0.0f, 0.01f, 1.0f})
        for (const float ior : {0.0f, 1.0f, 1.5f, 1e6f})
            for (const float x : {0.0f, 0.9f, 0.99999f, 1.0f}) {
                const Vec3f o = Vec3f(x, 0, std::sqrt(1 - x * x));
                for (const Vec3f& viewer : {o, Vec3f(o.x, o.y, -o.z)}) {
                    const Surface surface =
                        glossy(Rgb(1, 0, 0.5f), {.roughness = roughness, .ior = ior});
                    const GlossyLobe lobe(surface, n, viewer);
                    for (std::uint64_t k = 0; k < 100; ++k) {
                        const Vec3f i =
                            lobe.sample(toUnitFloat(static_cast<std::uint32_t>(k) << 25),
                                        k == 99 ? 0x1.fffffep-1f : 0.01f * static_cast<float>(k));
                        EXPECT_NEAR(i.length(), 1, 1e-5);
                        const Rgb weighted = lobe.value(i) / std::max(lobe.density(i), 1e-30f);
                        if (lobe.value(i) == Rgb(0.0f)) continue;
                        EXPECT_GT(lobe.density(i), 0);
                        for (int c = 0; c < 3; ++c) EXPECT_LE(std::abs(weighted[c]), 20.0f);
                    }
                }
            }
}

TEST(GlossyLobe, DensityIntegratesToOne) {
    constexpr int kSteps = 700;
    for (const float roughness : {0.3f, 0.6f, 1.0f})
        for (const double cosine : {1.0, 0.7, 0.2}) {
            const Vec3f viewer(static_cast<float>(std::sqrt(1 - cosine * cosine)), 0,
                               static_cast<float>(cosine));
            const GlossyLobe lobe(glossy(Rgb(1, 1, 1), {.roughness = roughness}), Vec3f(0, 0, 1),
                                  viewer);
            double sum = 0;
            for (int y = 0; y < kSteps; ++y) {
                const double z = 2 * (y + 0.5) / kSteps - 1, r = std::sqrt(1 - z * z);
                for (int x = 0; x < 2 * kSteps; ++x) {
                    const double phi = kPi * (x + 0.5) / kSteps;
                    sum += static_cast<double>(
                        lobe.density(Vec3f(Vec3d(r * std::cos(phi), r * std::sin(phi), z))));
                }
            }
            EXPECT_NEAR(sum * 4 * kPi / (2.0 * kSteps * kSteps), 1, 3e-3)
                << roughness << " " << cosine;
        }
}

/// p-value that the mirrors drawn for a viewer have the density of visible ones of some roughness.
double mirrorsPValue(const GlossyLobe& lobe, double cosine, double roughness) {
    constexpr int kBins = 12, kSamples = 300000;
    std::vector<double> observed(kBins * kBins), expected(kBins * kBins);
    const double alpha = roughness * roughness;
    const Vec3d o(std::sqrt(1 - cosine * cosine), 0, cosine);
    for (int k = 0; k < kSamples; ++k) {
        const auto number = static_cast<std::uint64_t>(k);
        const Vec3d i(lobe.sample(static_cast<float>(toUnit(hashWords(number, 11))),
                                  static_cast<float>(toUnit(hashWords(number, 12)))));
        const Vec3d h = (o + i).normalized();
        const double tangent2 = (h.x * h.x + h.y * h.y) / (h.z * h.z);
        const double a = 1 / (1 + tangent2 / (alpha * alpha));
        double p = std::atan2(h.y, h.x) / (2 * kPi);
        p -= std::floor(p);
        const auto bin = [](double x) {
            return std::min(static_cast<std::size_t>(x * kBins), std::size_t{kBins - 1});
        };
        ++observed[bin(a) * kBins + bin(p)];
    }
    double total = 0;
    for (std::size_t x = 0; x < kBins; ++x)
        for (std::size_t y = 0; y < kBins; ++y) {
            const auto a = static_cast<double>(x) / kBins, p = static_cast<double>(y) / kBins;
            double& cell = expected[x * kBins + y];
            cell = test::visibleNormalProbability(alpha, cosine, a, a + 1.0 / kBins, p,
                                                  p + 1.0 / kBins);
            total += cell;
        }
    EXPECT_NEAR(total, 1, 1e-3);
    for (double& cell : expected) cell *= kSamples / total;
    return test::chiSquaredPValue(observed, expected);
}

TEST(GlossyLobe, SamplesFollowTheVisibleMirrors) {
    const std::vector<double> roughness{0.1, 0.4, 1}, cosines{1, 0.6, 0.1};
    const double level = test::significance(roughness.size() * cosines.size());
    for (const double r : roughness)
        for (const double cosine : cosines) {
            const Vec3f viewer(Vec3d(std::sqrt(1 - cosine * cosine), 0, cosine));
            // The lobe's space turns the azimuth only for other normals than z.
            const GlossyLobe lobe(glossy(Rgb(1, 1, 1), {.roughness = static_cast<float>(r)}),
                                  Vec3f(0, 0, 1), viewer);
            EXPECT_GT(mirrorsPValue(lobe, cosine, r), level) << r << " " << cosine;
            // Control: two per cent rougher.
            const GlossyLobe other(
                glossy(Rgb(1, 1, 1), {.roughness = static_cast<float>(0.98 * r)}), Vec3f(0, 0, 1),
                viewer);
            EXPECT_LT(mirrorsPValue(other, cosine, r), level) << r << " " << cosine;
        }
}

}  // namespace
}  // namespace shadowcache
