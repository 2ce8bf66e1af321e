#pragma once

#include <vector>

#include "common/light/environment.h"

namespace shadowcache::study {

/// Light from one direction in place of a part of a map.
struct DirectionalLight {
    Vec3f direction;       ///< unit, toward the light
    Rgb radianceIntegral;  ///< over the part [radiance sr]
};

/// At most `count` lights that stand for the map: its cells clustered by direction, weighted by
/// their luminance. The sum of their integrals is the map's. [paper 3.1, Cohen & Debevec 2001]
std::vector<DirectionalLight> clusterLights(const Environment& environment, int count);

}  // namespace shadowcache::study
