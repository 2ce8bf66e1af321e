#pragma once

#include <optional>
#include <string>

#include "common/math/vec.h"

namespace shadowcache {

/// Directions around its axis to which a spot shines. Up to the inner angle nothing is lost; from
/// there the light falls off, linearly in the cosine, to none at the outer one.
struct LampCone {
    double cosInner = 1;  ///< above cosOuter
    double cosOuter = 0;
    bool smooth = false;  ///< the falloff is its smoothstep, as Blender's; else its square, as
                          ///< KHR_lights_punctual has it
    bool isFlat = false;  ///< times the cosine, as in Blender up to 3.6

    bool operator==(const LampCone&) const = default;
};

/// Light without a surface: it stops no ray.
struct Lamp {
    enum class Form {
        point,      ///< a disc that faces whatever it lights; without a radius a point
        sun,        ///< infinitely far; without an angle one direction
        rectangle,  ///< lit on one side, like an ellipse
        ellipse
    };
    static constexpr double kLeastSpread = 0.01;  ///< [rad]: less would be a laser

    std::string name;
    Form form = Form::point;
    /// Of a point, and of areas along `direction`: radiant intensity, [radiance] times m^2. Of a
    /// sun: irradiance across `direction`, [radiance] times sr. At least 0.
    Rgb strength{0, 0, 0};
    Rgb gain{1, 1, 1};                              ///< times the strength; at least 0
    Vec3d position{0, 0, 0};                        ///< of its middle, as those of the mesh
    Vec3d direction{0, 0, -1};                      ///< unit: to where it shines
    Vec3d halfWidth{0, 0, 0}, halfHeight{0, 0, 0};  ///< of areas: from the middle to two sides
    double radius = 0;                              ///< of points
    double angle = 0;                ///< of suns: diameter of the disc, 0 to pi [rad]
    std::optional<LampCone> cone{};  ///< of points: makes a spot
    /// Of areas, kLeastSpread to pi [rad]: at an angle t to `direction` slats before them leave the
    /// share max(0, 1 - tan(t) / tan(spread / 2)); pi: there are none.
    double spread = kPi;
    bool moves = false;  ///< an animation moves it: this is its place in one frame
    /// Cameras see it where it has an extent: it adds its radiance to that of what is behind it.
    bool seenByCamera = false;

    bool operator==(const Lamp&) const = default;
};

}  // namespace shadowcache
