#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/emitters/emitters.h"
#include "common/import/light_group.h"
#include "common/predict/grouped_light.h"
#include "common/trace/scene.h"

namespace shadowcache {

/// Which light is kept apart: that of the sky, and of what shines in a set. Immutable, thread-safe.
class LightGroups {
public:
    /// The group of the sky.
    static constexpr std::size_t kSky = 0;

    /// @param emitters  of the mesh; null: nothing in it shines. All outlive this object
    /// @throws Error as lightGroupNames()
    LightGroups(std::span<const LightGroupRule> rules, const TriangleMesh& mesh,
                const Emitters* emitters);

    std::size_t size() const { return names_.size(); }
    const std::vector<std::string>& names() const { return names_; }

    /// The group of a part of the emitters.
    std::size_t ofPart(std::size_t part) const { return ofPart_[part]; }
    /// The group of what a surface emits that a ray met, of what moves, too.
    std::size_t ofHit(const Hit& hit) const;

    /// Adds the irradiance by an emitter, times a factor, to those of its groups: by what they
    /// emit, where an emitter is of several.
    void add(std::size_t emitter, const Rgb& irradiance, float factor, std::span<Rgb> light) const;

private:
    /// What a group has of an emitter's light.
    struct Share {
        std::size_t group;
        Rgb part;
    };

    std::size_t ofMaterial(const Material* material) const;
    std::vector<Share> sharesOf(std::span<const EmitterPart> parts, std::size_t first) const;

    const TriangleMesh& mesh_;
    const std::vector<LightGroupRule> rules_;
    const std::vector<std::string> names_;
    std::vector<std::size_t> ofMaterial_;  ///< of the mesh's
    std::vector<std::size_t> ofPart_;
    std::vector<std::vector<Share>> shares_;  ///< by emitter
};

/// Where the light of each group is to be added; nowhere, if there are none.
struct GroupSink {
    const LightGroups* groups = nullptr;
    GroupedLight* light = nullptr;

    explicit operator bool() const { return light != nullptr; }
    std::span<Rgb> at(std::size_t place) const { return (*light)[place]; }
    /// Adds light of a group at a place, times a factor.
    void add(std::size_t place, std::size_t group, const Rgb& value, float factor) const;
};

}  // namespace shadowcache
