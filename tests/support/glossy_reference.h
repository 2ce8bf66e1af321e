#pragma once

#include <vector>

#include "common/image/image.h"
#include "common/surface/surface.h"
#include "render/estimators/estimator.h"

namespace shadowcache::test {

// The metallic-roughness BRDF in double, written from glTF's Appendix B and not from the product's
// code, and integrals of it.

/// A base colour and its gloss.
struct GlossyLook {
    Rgb baseColor;
    Gloss gloss;
};

/// Rough and smooth, metal, dielectric and between.
std::vector<GlossyLook> glossyLooks();

/// BRDF for unit vectors above the horizon of the unit normal n [1/sr].
Vec3d referenceBrdf(const GlossyLook& look, const Vec3d& n, const Vec3d& toViewer,
                    const Vec3d& toLight);

/// Share of a white sky's light that the surface reflects to a viewer at `cosine` to its normal: by
/// quadrature over the normals of the mirrors, and for the base over the hemisphere.
Vec3d referenceAlbedo(const GlossyLook& look, double cosine);

/// Probability that a visible mirror's normal lies in a cell of the plane (a, phi / 2 pi), where a
/// = 1 / (1 + tan^2 / alpha^2) and phi is its azimuth from the viewer's: for [a0, a1] x [p0, p1].
double visibleNormalProbability(double alpha, double cosine, double a0, double a1, double p0,
                                double p1);

/// Radiance that a look at `point` reflects from a map to the viewer, by a ray per texel, of which
/// small maps have half a million, too.
Rgb tracedReflection(const Scene& scene, const ShadingPoint& point, const GlossyLook& look,
                     const Vec3d& toViewer, const Environment& environment);

/// Radiance of green, by seeds 1 to `seeds`, that an estimator finds reflected by a lobe at a place
/// with 8 samples.
std::vector<double> reflectedBySeeds(const Estimator& estimator, const ShadingPoint& point,
                                     const GlossyLobe& lobe, std::uint64_t seeds);

}  // namespace shadowcache::test
