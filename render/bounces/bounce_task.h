#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "common/mesh/looks.h"
#include "common/predict/grouped_light.h"
#include "render/estimators/estimator.h"

namespace shadowcache {

/// Bounces that Russian roulette ends, not a number.
inline constexpr int kUnlimitedBounces = -1;

/// Most bounces that can be asked for by number.
inline constexpr int kMostBounces = 1000;

/// How light bounces.
struct BounceOptions {
    int most = 0;       ///< surfaces that light may meet before the one that the camera sees;
                        ///< kUnlimitedBounces: any number
    float clamp = 0;    ///< luminance above which what bounces add to a camera ray is cut, which is
                        ///< biased; 0: it is not
    PlainLook plain{};  ///< of what has no material
    bool shared = true;   ///< near vertices share what their rays meet; else brute force
    int raysOfPixel = 1;  ///< camera rays of a pixel that are gathered together, about
    float trust = 1;      ///< part of what is predicted of paths' vertices that they count with, in
                          ///< [0, 1]
};

/// Compares bounced light as it is predicted with what rays found.
class PredictionCheck {
public:
    /// Both times the weight of the vertex.
    void add(double predicted, double found) {
        squares_ += predicted * predicted;
        products_ += predicted * found;
    }

    /// The part of the prediction that is nearest to what was found, by least squares; 1 where
    /// nothing was predicted.
    float trust() const {
        return squares_ > 0 ? static_cast<float>(std::clamp(products_ / squares_, 0.0, 1.0)) : 1;
    }

private:
    double squares_ = 0, products_ = 0;
};

/// What paths from a few places tell of a frame.
struct PathPilot {
    PredictionCheck check{};
    std::vector<ShadingPoint> vertices{};  ///< those that are lit
};

/// A place that a camera ray met, whose light from other surfaces is wanted.
struct BounceReceiver {
    const ShadingPoint* point = nullptr;
    Rgb diffuseAlbedo{0, 0, 0};
    bool diffuse = true;               ///< its irradiance is wanted
    const GlossyLobe* lobe = nullptr;  ///< toward the camera; null: it is not glossy
};

/// Light that reaches it from other surfaces.
struct BouncedLight {
    Rgb irradiance{0, 0, 0};  ///< [radiance sr]
    Rgb glossy{0, 0, 0};      ///< reflected by its lobe [radiance]
    Rgb predicted{0, 0, 0};   ///< irradiance predicted without rays, if it is [radiance sr]
    float exposure = 1;  ///< share of the items' surface that no other one hides: predicted direct
                         ///< light is divided by it (common/predict/exposure.h)
};

/// The same of all receivers by light group; empty without groups.
struct GroupedBounce {
    GroupedLight irradiance, glossy;
};

/// What light that bounces took.
struct BounceCounts {
    std::uint64_t pathRays = 0;    ///< that look for the next surface
    std::uint64_t sharedRays = 0;  ///< that look whether a place sees what another one's ray met
    std::uint64_t shadowRays = 0;  ///< of the direct light of what paths met
    std::uint64_t vertices = 0;    ///< that paths met

    std::uint64_t rays() const { return pathRays + sharedRays + shadowRays; }
    void add(const BounceCounts& other) {
        pathRays += other.pathRays;
        sharedRays += other.sharedRays;
        shadowRays += other.shadowRays;
        vertices += other.vertices;
    }
};

}  // namespace shadowcache
