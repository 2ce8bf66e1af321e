#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/shot/camera.h"

namespace shadowcache {

/// A camera that a program states: {"origin", "forward", "up", "yfov" or "height"} and, where
/// wanted, "shift" and "pixel_aspect", as a frame of a camera file has them. Other keys are refused.
///
/// @param name  what it is called in messages
/// @throws Error naming the key, the value found and the one wanted
Camera cameraOf(const nlohmann::json& json, const std::string& name);

}  // namespace shadowcache
