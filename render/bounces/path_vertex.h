#pragma once

#include <cstdint>
#include <vector>

#include "common/cache/item_table.h"
#include "common/surface/surface.h"

namespace shadowcache {

/// Number of a vertex that is not there.
inline constexpr std::int32_t kNoVertex = -1;

/// A place where a path of light turns: one that a camera ray met, or one that a ray from an
/// earlier vertex met. Directions are unit vectors; places are relative to the set's origin.
struct PathVertex {
    Vec3f origin;           ///< where its rays start
    Vec3f target;           ///< on its surface, just off it: where rays that look for it end
    Vec3f normal;           ///< shading normal, on the side that was met
    Vec3f geometricNormal;  ///< of the triangle, on that side
    Rgb albedo;             ///< of the diffuse part, as seen along the ray that met it
    Rgb emission;           ///< [radiance]
    std::uint64_t seed = 0;
    std::uint64_t pixelSeed = 0;   ///< alike for all that one pixel's camera rays met; else its own
    std::uint32_t item = kNoItem;  ///< that predicts its irradiance
    float weight = 1;              ///< by which its radiance counts in its pixel, about [luminance]
    float errorScale = 0;      ///< luminance that errors of its pixel are relative to; 0: unknown
    Rgb throughLobe{0, 0, 0};  ///< reflected share of its radiance, if a lobe's ray met it
    std::int32_t lobe = -1;    ///< of the level's lobes; -1: not glossy
    std::int32_t diffuseChild = kNoVertex;  ///< in the next level: what its diffuse ray met
    std::int32_t lobeChild = kNoVertex;     ///< and its lobe's ray
    float diffuseChance = 0;                ///< with which it sends a diffuse ray; 0: it may not
    float lobeChance = 0;                   ///< and a ray of its lobe
    bool sendsDiffuse = false, sendsLobe = false;  ///< what was decided by these
    bool isLit = false;                            ///< its direct light is estimated
    float numbers[2] = {0, 0};                     ///< in [0, 1): direction of the diffuse ray
    Rgb predicted{0, 0, 0};                        ///< irradiance that bounces are predicted to add
    Rgb irradiance{0, 0, 0};  ///< what is known of it, from all bounces that are left
    Rgb mirrored{0, 0, 0};    ///< radiance that its lobe sends to where it was met from

    /// Radiance that it sends to all sides.
    Rgb diffuseRadiance() const {
        return emission + albedo * irradiance * static_cast<float>(1 / kPi);
    }
};

/// The vertices that are as many bounces from the camera.
struct PathLevel {
    std::vector<PathVertex> vertices;
    std::vector<GlossyLobe> lobes;  ///< toward where they were met from
};

}  // namespace shadowcache
