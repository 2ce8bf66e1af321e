#pragma once

#include "common/cache/cache_header.h"
#include "common/light/environment.h"

namespace shadowcache {

/// Unshadowed light of sixteen cells on a surface. In cells above the horizon the cosine is exact,
/// cells below it are dark; in cells that it cuts a quadratic replaces the clamped cosine
/// (HorizonFit).
struct CellLight {
    /// [colour]: integral of the radiance times the cosine [radiance sr]
    alignas(64) float irradiance[3][kBlockCells];
    /// Integral of the luminance times the cosine; across the horizon without the cosine, which is
    /// in the moments [radiance sr]
    alignas(64) float light[kBlockCells];
    alignas(64) float cosineMoment[kBlockCells];  ///< mean of the clamped cosine^2; 1 above
    alignas(64) float fitMoment[kBlockCells];     ///< mean of its replacement^2; 1 above
    bool anyHorizon;                              ///< whether the horizon cuts any of the cells
};

/// Light of the cells that `m` describes on a surface of unit normal `n`.
void lightCells(const CellMoments& m, const Vec3f& n, const Rgb& luminanceWeights, CellLight& out);

}  // namespace shadowcache
