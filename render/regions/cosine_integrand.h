#pragma once

#include <span>

#include "common/base/tuned.h"
#include "render/estimators/shading_point.h"
#include "render/regions/region_builder.h"
#include "render/regions/region_shares.h"

namespace shadowcache {

/// Pixels of a group for each that is mispredicted, on average: the gain saturates at one, but a
/// reused ray costs a tenth of a sample.
inline SHADOWCACHE_TUNED(double, kGroupPerFind, 8);

/// The cosine of points whose normals are within an angle of a cluster's: light on a surface.
class CosineIntegrand {
public:
    /// The stand-in of the cosine at x = n . w: constant + linear x + square x^2.
    struct alignas(64) Fit {
        alignas(64) float constant[kBlockCells];
        alignas(64) float linear[kBlockCells];
        alignas(64) float square[kBlockCells];
        bool cut;  ///< some region lies across the horizon

        float value(int i, float x) const { return constant[i] + x * (linear[i] + x * square[i]); }
    };
    struct Scratch {
        CellLight sky;
    };

    /// Above the horizon, the cosine is linear in x.
    static constexpr bool kFitIsExact = true;

    /// The cosines of a batch's points.
    struct Points {
        std::span<const ShadingPoint> points;

        const Vec3f& normal(std::uint32_t point) const { return points[point].place.normal; }
        /// Of a point along a unit vector, over a density.
        float value(std::uint32_t point, const Vec3f& w, double density) const {
            return static_cast<float>(static_cast<double>(w.dot(points[point].place.normal)) /
                                      density);
        }
        /// None draws samples of its own beside those of the regions.
        double lobeDensity(std::uint32_t, const Vec3f&) const { return 0; }
        static double groupPerFind() { return kGroupPerFind; }
    };

    /// @param tilt  sine of the widest angle between `normal` and a point's
    /// @param leastNoise  of a cell: below it the cell stays whole, as below the splitter's own
    ///                    [radiance sr]
    CosineIntegrand(const Environment& environment, const CellSplitter& splitter,
                    const Vec3f& normal, float tilt, float leastNoise);

    bool look(const CellBlock& block, Scratch& scratch) const;
    void split(const CellBlock& block, const CellVisibility& v, const PooledVisibility& pooled,
               Scratch& scratch, Splits& splits) const;
    void describe(const CellBlock& block, const Splits& splits, Scratch& scratch,
                  RegionEvidence& evidence) const;
    void fit(const CellBlock& block, const Scratch& scratch, Fit& fit) const;

private:
    const Environment& environment_;
    const CellSplitter& splitter_;
    Vec3f normal_;
    float tilt_;
    float leastNoise_;
};

/// Noise of a cell, times the samples of its cluster, below which splitting it costs more time than
/// it saves. With `fine` the deviation of a sample in a frame's mean where all cells are split that
/// can be, and `coarse` where none is, a split of a cell of noise x lowers the deviation by about
/// x (coarse - fine) / coarse; where it hardly does, as among leaves, few pay.
///
/// @param fine, coarse  at least 0 [radiance sr], as the result
double splitNoise(double fine, double coarse);

/// The control variate's integral as a polynomial of a point's own normal n: with the cosine's
/// stand-in q(x) = q0 + q1 x + q2 x^2, x = n . w, of each region, c its visibility and L the light,
/// sum over the regions of c * integral of L q = A + B . n + n^T D n. Exact for every n, whatever
/// normal the coefficients were chosen for. [docs/estimator.md]
class CosineIntegral {
public:
    CosineIntegral(const Environment& environment, const FittedRegions<CosineIntegrand>& fitted,
                   const RegionShares& shares);

    Rgb at(const Vec3f& normal) const;

private:
    void addGroup(const CellMoments& m, const CosineIntegrand::Fit& fit, const GroupShares& shares);

    double constant_[3] = {};   ///< A, by colour
    double linear_[3][3] = {};  ///< B
    double square_[3][6] = {};  ///< D: xx, yy, zz, xy, xz, yz
};

}  // namespace shadowcache
