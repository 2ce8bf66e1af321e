#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace shadowcache {

struct Camera;

/// A camera that a program states: "origin", "forward" and "up" as in a frame of a camera file, and
/// "yfov" or, of an orthographic one, "height" of the view in metres. Other keys are refused.
///
/// @param name  what it is called in messages
/// @throws Error naming the key, the value found and the one wanted
Camera cameraOf(const nlohmann::json& json, const std::string& name);

}  // namespace shadowcache
