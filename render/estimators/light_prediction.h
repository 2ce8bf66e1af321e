#pragma once

#include "render/estimators/shading_point.h"
#include "render/estimators/workspace.h"

namespace shadowcache {

/// Irradiance predicted without rays.
class LightPrediction {
public:
    virtual ~LightPrediction() = default;
    /// @return [radiance sr]
    virtual Rgb predict(const SetPlace& place, Workspace& workspace) const = 0;
};

}  // namespace shadowcache
