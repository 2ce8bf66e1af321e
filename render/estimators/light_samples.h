#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/light/environment.h"
#include "common/trace/scene.h"
#include "render/estimators/estimate.h"
#include "render/estimators/shading_point.h"

namespace shadowcache {

/// What a sample brings whose ray passes panes that tint it.
inline Rgb tinted(const Rgb& ifVisible, const Rgb& ifOccluded, const Rgb& tint) {
    return ifOccluded + (ifVisible - ifOccluded) * tint;
}

/// Directions to test for occlusion, and what each adds to the irradiance if it is visible or
/// occluded.
class LightSamples {
public:
    void clear();
    void add(const Vec3f& direction, const Rgb& ifVisible, const Rgb& ifOccluded = Rgb(0, 0, 0));
    /// A sample whose contribution is zero whether visible or not.
    void addZero() { add(Vec3f(0, 0, 0), Rgb(0, 0, 0)); }
    std::size_t size() const { return direction_.size(); }
    /// Whether sample `i`, whose direction is not zero, was visible; after trace().
    bool visible(std::size_t i) const { return visible_[i] != 0; }
    const Vec3f& direction(std::size_t i) const { return direction_[i]; }

    /// Ends a group of samples that estimate the same thing; the variance is estimated from
    /// differences within groups.
    void endGroup() { groupEnds_.push_back(size()); }

    /// Traces all rays from `place`; the sum of the contributions is added to `estimate`.
    void trace(const Scene& scene, const SetPlace& place, const Environment& environment,
               Estimate& estimate);

private:
    std::vector<Vec3f> direction_;
    std::vector<Rgb> ifVisible_, ifOccluded_;
    std::vector<std::uint8_t> visible_;
    std::vector<std::size_t> groupEnds_;
};

}  // namespace shadowcache
