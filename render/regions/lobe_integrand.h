#pragma once

#include <span>

#include "common/base/tuned.h"
#include "common/surface/surface.h"
#include "render/estimators/shading_point.h"
#include "render/regions/quadratic_cells.h"
#include "render/regions/region_builder.h"
#include "render/regions/region_shares.h"

namespace shadowcache {

/// Pixels of a group for each that is mispredicted, on average: more than for the irradiance, as
/// lobes differ, so that fewer points gain from a misprediction.
inline SHADOWCACHE_TUNED(double, kGlossyGroupPerFind, 16);

/// The lobe of the central point of a cluster of glossy points: light that they reflect to the
/// viewer. In each region a quadratic stands in for it, whose integral against the light is exact.
/// [docs/estimator.md]
class LobeIntegrand {
public:
    using Fit = QuadraticFit;
    /// Means over sixteen cells, of the luminance that a lobe reflects of white light. [1/sr]
    struct Moments {
        alignas(64) float square[kBlockCells];  ///< of the lobe^2
        alignas(64) float fit[kBlockCells];     ///< of its fit^2
        alignas(64) float error[kBlockCells];   ///< of the difference^2
    };
    struct Scratch {
        QuadraticFit fit;
        Moments moments;
    };

    /// What the lobe differs from its fit is found whatever a ray meets.
    static constexpr bool kFitIsExact = false;

    /// The lobes of a batch's points.
    struct Points {
        std::span<const GlossyPoint> points;

        const Vec3f& normal(std::uint32_t point) const { return points[point].lobe.normal(); }
        /// Of a point along a unit vector, over a density.
        Rgb value(std::uint32_t point, const Vec3f& w, double density) const {
            return points[point].lobe.value(w) * static_cast<float>(1 / density);
        }
        /// Density of a sample that a point draws from its own lobe.
        double lobeDensity(std::uint32_t point, const Vec3f& w) const {
            return static_cast<double>(points[point].lobe.density(w));
        }
        static double groupPerFind() { return kGlossyGroupPerFind; }
    };

    /// @param leastNoise  of an irradiance, below which a cell stays whole [radiance sr]
    /// @param misfit  mean square of what the points' lobes differ from this one, relative to it; 1
    ///                or more: the quadratics are of no use
    LobeIntegrand(const Environment& environment, const QuadraticCells& cells,
                  const DirectionTiers& tiers, float leastNoise, const GlossyLobe& lobe,
                  float misfit);

    bool look(const CellBlock& block, Scratch& scratch) const;
    void split(const CellBlock& block, const CellVisibility& v, const PooledVisibility& pooled,
               Scratch& scratch, Splits& splits) const;
    void describe(const CellBlock& block, const Splits& splits, Scratch& scratch,
                  RegionEvidence& evidence) const;
    void fit(const CellBlock& block, const Scratch& scratch, Fit& fit) const;

private:
    const Environment& environment_;
    const QuadraticCells& cells_;
    int refinements_;
    float leastNoise_;
    GlossyLobe lobe_;
    float misfit_;
    Vec3f mirrored_;
    float peak_;   ///< of the lobe, about [luminance]
    float plain_;  ///< what a region's lobe is taken for, at least
};

/// What the control variate reflects of the light, for the central lobe: the sum over the regions
/// of c times the integral of L q.
Rgb integralOf(const QuadraticCells& cells, const FittedRegions<LobeIntegrand>& fitted,
               const RegionShares& shares);

/// What the cache predicts that the lobe reflects, without a ray: the same with the visibility that
/// is predicted of all regions.
Rgb predictionOf(const QuadraticCells& cells, const FittedRegions<LobeIntegrand>& fitted);

}  // namespace shadowcache
