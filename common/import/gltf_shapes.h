#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace shadowcache {

/// Refuses what tinygltf passes over in silence, with its default in place: numbers and lists of
/// another kind or length, words that glTF does not know, matrices that are not affine.
///
/// @param document  an object
/// @throws Error naming the file, the object and what was expected
void requireShapes(const std::filesystem::path& path, const nlohmann::json& document);

}  // namespace shadowcache
