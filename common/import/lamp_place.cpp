#include "common/import/lamp_place.h"

#include <fmt/core.h>

#include <algorithm>

#include "common/base/error.h"
#include "common/math/limits.h"

namespace shadowcache {

namespace {

/// Scale of what moves below which its lamp is off: less than an animation that hides it shows a
/// frame's rounding away from its key.
constexpr double kLeastScale = 1e-4;

[[noreturn]] void refuseFar(const std::filesystem::path& file, const Lamp& lamp) {
    throwFileError(
        file, fmt::format("lamp {}: is not within {:g} of the origin", lamp.name, kMostCoordinate));
}

}  // namespace

bool hasSize(const Affine& place) {
    return std::ranges::any_of(
        place.axis, [](const Vec3d& axis) { return axis.length2() > kLeastScale * kLeastScale; });
}

std::optional<Lamp> placedLamp(Lamp lamp, const Affine& toWorld) {
    const Vec3d shines = toWorld.vector(lamp.direction).normalized();
    lamp.position = toWorld.point(lamp.position);
    lamp.direction = shines;
    const bool isArea = lamp.form == Lamp::Form::rectangle || lamp.form == Lamp::Form::ellipse;
    if (isArea) {
        lamp.halfWidth = toWorld.vector(lamp.halfWidth);
        lamp.halfHeight = toWorld.vector(lamp.halfHeight);
        const Vec3d normal = lamp.halfWidth.cross(lamp.halfHeight).normalized();
        lamp.direction = normal.dot(shines) < 0 ? -normal : normal;
    }
    const bool isRound = lamp.form == Lamp::Form::point && !lamp.cone;
    if (!isRound && !(lamp.direction.length2() > 0.5)) return {};
    return lamp;
}

void changeUnit(Lamp& lamp, double unit) {
    lamp.radius *= unit;
    if (lamp.form != Lamp::Form::sun) lamp.strength *= static_cast<float>(unit * unit);
}

Lamp lampOfSet(const std::filesystem::path& file, const Lamp& lamp, const MeshOptions& options) {
    std::optional<Lamp> placed = placedLamp(lamp, worldOf(options));
    if (!placed || !isInReach(placed->position)) refuseFar(file, lamp);
    changeUnit(*placed, options.scale);
    placed->gain = lampGainOf(placed->name, options.gains);
    return *std::move(placed);
}

Lamp trackedLamp(const std::filesystem::path& file, const Lamp& lamp, const Affine& track) {
    std::optional<Lamp> placed = hasSize(track) ? placedLamp(lamp, track) : std::nullopt;
    if (!placed) {
        placed = lamp;
        placed->gain = Rgb(0, 0, 0);
    }
    if (!isInReach(placed->position)) refuseFar(file, lamp);
    return *std::move(placed);
}

}  // namespace shadowcache
