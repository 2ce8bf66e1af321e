#pragma once

#include <algorithm>

#include "common/predict/pooled_visibility.h"
#include "common/predict/posterior.h"

namespace shadowcache {

/// c and the posterior mean of the visibility in each of sixteen cells.
struct CellVisibility {
    alignas(64) float c[kBlockCells];
    alignas(64) float posterior[kBlockCells];
};

/// What a cell hands down to its children.
struct ParentVisibility {
    float c;
    float posterior;
};

/// That of the sphere, above the base cells.
inline ParentVisibility sphereVisibility(const PooledVisibility& pooled) {
    float visible = 0, counted = 0;
    for (std::uint32_t b = 0; b < pooled.baseBlocks(); ++b)
        for (int i = 0; i < kBlockCells; ++i) {
            visible += pooled.base(b).visible[i];
            counted += pooled.base(b).weight[i];
        }
    return {0, spherePrior(visible, counted)};
}

/// @param counts  of the cells, or null: then they are as their parent
inline void estimateVisibility(const PooledBlock* counts, const ParentVisibility& parent,
                               CellVisibility& out) {
    if (!counts) {
        for (int i = 0; i < kBlockCells; ++i) {
            out.c[i] = parent.c;
            out.posterior[i] = parent.posterior;
        }
        return;
    }
    for (int i = 0; i < kBlockCells; ++i) {
        const float rays = counts->rays[i] * counts->rays[i] / std::max(counts->rays2[i], 1e-30f);
        const float c = counts->ratioOrNone(i);
        out.c[i] = c;
        out.posterior[i] = posteriorVisibility(c * rays, rays, parent.posterior);
    }
}

/// Mean square of the residual in a region that is visible with probability `a` and whose
/// visibility the control variate takes for `c`, in units of its light. The two moments are those
/// of the integrand and of the fit that stands in for it.
inline float residualMoment(float a, float c, float moment, float fitMoment) {
    return a * (moment - fitMoment) + fitMoment * (a * (1 - c) * (1 - c) + (1 - a) * c * c);
}

}  // namespace shadowcache
