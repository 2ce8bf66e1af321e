#pragma once

#include "render/estimators/shading_point.h"
#include "render/estimators/workspace.h"

namespace shadowcache {

/// What the cache predicts at a place before any ray is traced there.
struct CacheInsight {
    float openness = 0;       ///< visible share of the sky, weighted by the cosine
    float expectedNoise = 0;  ///< standard deviation expected of the irradiance's luminance
    int items = 0;            ///< cache items found
    int regions = 0;          ///< regions that samples are drawn from
};

/// Reports what the cache predicts at a place.
class InsightSource {
public:
    virtual ~InsightSource() = default;
    /// @param plan  of the frame; may be null
    virtual CacheInsight insight(const ShadingPoint& point, int samples, const EstimatorPlan* plan,
                                 Workspace& workspace) const = 0;
};

}  // namespace shadowcache
