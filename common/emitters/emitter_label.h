#pragma once

#include <cstddef>
#include <string>

#include "common/emitters/emitters.h"

namespace shadowcache {

/// What messages call an emitter: "'desk'", by the name of its lamp or material.
std::string emitterLabel(const Emitters& emitters, std::size_t emitter);

}  // namespace shadowcache
