#include "common/emitters/emitter_label.h"

#include <algorithm>

namespace shadowcache {

std::string emitterLabel(const Emitters& emitters, std::size_t emitter) {
    const std::span<const EmitterPart> parts = emitters.partsOf(emitter);
    const std::string& first = emitters.nameOf(parts.front());
    const std::string label = first.empty() ? "an emitter without a name" : "'" + first + "'";
    const bool isOne = std::ranges::all_of(
        parts, [&](const EmitterPart& part) { return emitters.nameOf(part) == first; });
    return isOne ? label : label + " or a neighbour that shares its count";
}

}  // namespace shadowcache
