#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string_view>

namespace shadowcache {

/// Whether a URI holds its data itself ("data:...").
bool isDataUri(std::string_view uri);

/// Makes the URIs of a glTF document such as tinygltf reads: data of any media type, and buffers
/// that are shorter than their files, which then have all of the file.
///
/// @param path      the glTF file, for messages and the folder that it names files in
/// @param document  an object
/// @return whether anything changed
/// @throws Error naming the file: data that are not in base64
bool mendUris(const std::filesystem::path& path, nlohmann::json& document);

}  // namespace shadowcache
