#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/cache/item_table.h"
#include "common/predict/grouped_light.h"
#include "common/surface/surface.h"

namespace shadowcache {

/// A place where a path of light turns: one that a camera ray met, or one that a ray from an
/// earlier vertex met. Directions are unit vectors; places are relative to the set's origin.
struct PathVertex {
    static constexpr std::int32_t kNotGlossy = -1;

    Vec3f origin;           ///< where its rays start
    Vec3f target;           ///< on its surface, just off it: where rays that look for it end
    Vec3f normal;           ///< shading normal, on the side that was met
    Vec3f geometricNormal;  ///< of the triangle, on that side

    Rgb albedo;                       ///< of the diffuse part, as seen along the ray that met it
    Rgb emission{0, 0, 0};            ///< that no direct light has [radiance]
    std::uint32_t emissionGroup = 0;  ///< its light group
    std::int32_t lobe = kNotGlossy;   ///< number in PathVertices::lobes
    std::uint32_t item = kNoItem;     ///< cache item that predicts its irradiance

    std::uint64_t seed = 0;
    std::uint64_t pixelSeed = 0;  ///< alike for all that one pixel's camera rays met; else its own
    float weight = 1;             ///< by which its radiance counts in its pixel, about [luminance]
    float errorScale = 0;      ///< luminance that errors of its pixel are relative to; 0: unknown
    Rgb throughLobe{0, 0, 0};  ///< reflected share of its radiance, if a lobe's ray met it
    Rgb tint{1, 1, 1};         ///< by panes on the way of the ray that met it

    bool sharesMirroredSky = false;  ///< what it mirrors of the sky is for all places that share
                                     ///< it (mirrored_sky.h), not in VertexLight::mirrored

    bool isGlossy() const { return lobe != kNotGlossy; }
};

/// Vertices that are as many bounces from the camera.
struct PathVertices {
    std::vector<PathVertex> vertices;
    std::vector<GlossyLobe> lobes;  ///< toward where the vertices were met from

    const GlossyLobe& lobeOf(const PathVertex& v) const {
        return lobes[static_cast<std::size_t>(v.lobe)];
    }
};

/// What is decided of a vertex before any ray from it.
struct VertexChoice {
    float diffuseChance = 0;                       ///< with which it sends a diffuse ray
    float lobeChance = 0;                          ///< and a ray of its lobe
    bool sendsDiffuse = false, sendsLobe = false;  ///< what was decided by these
    bool isLit = false;                            ///< its direct light is estimated

    bool any() const { return sendsDiffuse || sendsLobe || isLit; }
};

/// What the rays of a vertex met: numbers of vertices in the next level.
struct VertexChildren {
    static constexpr std::int32_t kNone = -1;

    std::int32_t diffuse = kNone;
    std::int32_t lobe = kNone;
    float cosine = 0;   ///< of the diffuse ray at the vertex
    float density = 0;  ///< with which it was drawn, as DirectionGuide has it
};

/// Light of a vertex, as far as it is known.
struct VertexLight {
    Rgb predicted{0, 0, 0};   ///< irradiance that bounces are predicted to add
    Rgb irradiance{0, 0, 0};  ///< from all bounces that are left
    Rgb mirrored{0, 0, 0};    ///< radiance that its lobe sends to where it was met from

    /// Light by what is predicted alone.
    static VertexLight of(const Rgb& predicted) { return {predicted, predicted, {0, 0, 0}}; }
};

/// Part of the brightness of its pixel that a vertex adds by an irradiance, about; of one whose
/// pixel is not known, the luminance that it adds.
///
/// @param luminanceWeights  of the environment's colour space
inline float partOfPixel(const PathVertex& v, const Rgb& irradiance, const Rgb& luminanceWeights) {
    const float added = v.weight * v.albedo.dot(luminanceWeights) *
                        irradiance.dot(luminanceWeights) * static_cast<float>(1 / kPi);
    return v.errorScale > 0 ? added / v.errorScale : added;
}

/// Radiance that a vertex sends to all sides.
inline Rgb diffuseRadiance(const PathVertex& v, const VertexLight& light) {
    return v.emission + v.albedo * light.irradiance * static_cast<float>(1 / kPi);
}

/// The same of one light group, by the irradiance that it has of it.
inline Rgb diffuseRadiance(const PathVertex& v, std::size_t group, const Rgb& irradiance) {
    const Rgb reflected = v.albedo * irradiance * static_cast<float>(1 / kPi);
    return group == v.emissionGroup ? v.emission + reflected : reflected;
}

/// VertexLight of all vertices of a level by light group; empty without groups.
struct GroupedVertexLight {
    GroupedLight predicted, irradiance;
    GroupedLight mirrored;  ///< empty as well where no vertex is glossy
};

/// Two numbers in [0, 1) for each vertex of a level: the direction of its diffuse ray.
using DirectionNumbers = std::vector<std::array<float, 2>>;

}  // namespace shadowcache
