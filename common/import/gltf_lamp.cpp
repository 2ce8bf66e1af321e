#include "common/import/gltf_lamp.h"

#include <fmt/core.h>

#include <cmath>

#include "common/base/error.h"
#include "common/import/gltf_object.h"
#include "common/import/lamp_place.h"

namespace shadowcache {

namespace {

enum class Type { point, spot, directional };
constexpr Named<Type> kTypes[] = {
    {"point", Type::point}, {"spot", Type::spot}, {"directional", Type::directional}};

struct Falloff {
    bool smooth, isFlat;
};
constexpr Named<Falloff> kFalloffs[] = {{"square", {false, false}},
                                        {"smoothstep", {true, false}},
                                        {"smoothstep times cosine", {true, true}}};
constexpr Named<Lamp::Form> kShapes[] = {{"rectangle", Lamp::Form::rectangle},
                                         {"ellipse", Lamp::Form::ellipse}};

/// Angles in single precision may be so much more than half a circle.
constexpr double kRounding = 1 + 1e-6;

/// A number within a range. @throws Error naming it
double numberWithin(const GltfObject& from, const char* key, double fallback, double most) {
    const double number = from.number(key, fallback);
    if (!(number >= 0 && number <= most)) from.refuse(key, fmt::format("0 to {:.4g}", most));
    return number;
}

Rgb strengthOf(const GltfObject& light) {
    const double intensity = numberWithin(light, "intensity", 1, kMostLampStrength);
    const std::vector<double> color = light.numbers("color", 3);
    Rgb strength(static_cast<float>(intensity));
    for (std::size_t k = 0; k < color.size(); ++k) {
        if (!(color[k] >= 0 && color[k] * intensity <= kMostLampStrength))
            light.refuse("color", "three numbers from 0 on");
        strength[static_cast<int>(k)] = static_cast<float>(color[k] * intensity);
    }
    return strength;
}

void readArea(const GltfObject& extras, Lamp& lamp) {
    lamp.form = extras.choice("shape", kShapes, Lamp::Form::rectangle);
    const std::vector<double> size = extras.numbers("size", 2);
    if (size.empty() || !(size[0] > 0 && size[1] > 0))
        extras.refuse("size", "width and height above 0");
    lamp.halfWidth = Vec3d(size[0] / 2, 0, 0);
    lamp.halfHeight = Vec3d(0, size[1] / 2, 0);
    lamp.spread = extras.number("spread", kPi);
    if (!(lamp.spread >= Lamp::kLeastSpread && lamp.spread <= kPi * kRounding))
        extras.refuse("spread", fmt::format("{:g} to {:.4g}", Lamp::kLeastSpread, kPi));
}

LampCone coneOf(const GltfObject& light, const GltfObject& extras) {
    const GltfObject spot = light.object("spot");
    const double outer = numberWithin(spot, "outerConeAngle", kPi / 4, kPi / 2 * kRounding);
    const double inner = numberWithin(spot, "innerConeAngle", 0, outer);
    const Falloff falloff = extras.choice("falloff", kFalloffs, Falloff{false, false});
    return {std::cos(inner), std::cos(outer), falloff.smooth, falloff.isFlat};
}

}  // namespace

Lamp gltfLamp(const GltfObject& light, LeftOutOf& leftOut) {
    const GltfObject extras = light.object("extras");
    Lamp lamp;
    lamp.name = light.name();
    lamp.strength = strengthOf(light);
    lamp.seenByCamera = extras.flag("camera", false);
    if (extras.has("spread") && !extras.has("shape"))
        ++leftOut[{"light", "spread of other than an area is left out"}];
    if (light.has("range")) ++leftOut[{"light", "range, a hint, is left out"}];
    if (!light.has("type")) light.fail("no type, expected point, spot or directional");
    const Type type = light.choice("type", kTypes, Type::point);
    if (type == Type::directional) {
        lamp.form = Lamp::Form::sun;
        lamp.angle = numberWithin(extras, "angle", 0, kPi);
    } else if (extras.has("shape")) {
        readArea(extras, lamp);
    } else {
        lamp.radius = numberWithin(extras, "radius", 0, kMostLampStrength);
        if (type == Type::spot) lamp.cone = coneOf(light, extras);
    }
    return lamp;
}

}  // namespace shadowcache
