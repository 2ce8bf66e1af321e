#include "render/estimators/frame_pilot.h"

#include "common/base/tuned.h"

namespace shadowcache {

namespace {

/// Places of the frame that a pilot looks at.
SHADOWCACHE_TUNED(std::size_t, kPilotPlaces, 1024);

}  // namespace

std::size_t FramePilot::places(std::uint64_t) const {
    return kPilotPlaces;
}

}  // namespace shadowcache
