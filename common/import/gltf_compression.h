#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace tinygltf {
class Model;
}

namespace shadowcache {

/// Makes a glTF document one in which tinygltf finds nothing missing where data are compressed:
/// buffer views of EXT_meshopt_compression are the compressed bytes, primitives of
/// KHR_draco_mesh_compression have their indices in the extension.
///
/// @param document  an object
/// @return whether anything changed
bool removeFallbacks(nlohmann::json& document);

/// Decodes what is compressed: buffer views, and accessors of primitives, that a model of
/// removeFallbacks() has.
///
/// @throws Error naming the file, the extension and the cause
void decompress(const std::filesystem::path& path, tinygltf::Model& model);

}  // namespace shadowcache
