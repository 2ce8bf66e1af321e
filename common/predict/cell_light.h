#pragma once

#include "common/cache/cache_header.h"
#include "common/light/environment.h"

namespace shadowcache {

/// What the sky adds through each of sixteen cells. Above the horizon the cosine is that of the
/// light itself; below it nothing comes; across it a quadratic stands in for the clamped cosine.
struct CellLight {
    alignas(64) float irradiance[3][kBlockCells];  ///< integral of the light times the cosine
    alignas(64) float light[kBlockCells];          ///< scale of a sample's contribution
    alignas(64) float cosineMoment[kBlockCells];   ///< mean of clamped cosine^2, in light^2
    alignas(64) float fitMoment[kBlockCells];      ///< mean of its stand-in^2, likewise
    bool anyHorizon;
};

/// Light of the cells `m` describes, on a surface of unit normal `n`.
void lightCells(const CellMoments& m, const Vec3f& n, const Rgb& luminanceWeights, CellLight& out);

}  // namespace shadowcache
