// What emitters give a place, by their closed forms and the cache's counts: no ray is traced.

#include <algorithm>

#include "render/estimators/emitter_light.h"

namespace shadowcache {

Rgb EmitterLight::predict(const SetPlace& place, Tools& tools, const GroupSink& sink,
                          std::size_t number) const {
    lookUp(place, tools);
    const Receiver at{place.rayOrigin, place.normal};
    Rgb sum(0, 0, 0);
    for (std::size_t e = 0; e < emitters_.size(); ++e) {
        const Rgb unoccluded = emitters_.irradiance(e, at).irradiance;
        const float share = tools.shares_[e] < 0 ? 1.0f : tools.shares_[e];
        sum += unoccluded * share;
        if (sink) sink.groups->add(e, unoccluded, share, sink.at(number));
    }
    return sum;
}

Rgb EmitterLight::predictItem(std::uint64_t item, const Receiver& place, Tools& tools,
                              const GroupSink& sink) const {
    visibility_->shares(item, tools.shares_);
    Rgb sum(0, 0, 0);
    for (std::size_t e = 0; e < emitters_.size(); ++e) {
        const Rgb unoccluded = emitters_.irradiance(e, place).irradiance;
        const float share = std::max(0.0f, tools.shares_[e]);
        sum += unoccluded * share;
        if (sink) sink.groups->add(e, unoccluded, share, sink.at(item));
    }
    return sum;
}

}  // namespace shadowcache
