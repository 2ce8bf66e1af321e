#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace tinygltf {
class Model;
}

namespace shadowcache {

/// JSON of a glTF file in which tinygltf finds nothing missing where data are compressed: buffer
/// views of EXT_meshopt_compression are the compressed bytes, primitives of
/// KHR_draco_mesh_compression have their indices in the extension.
///
/// @return nothing if there is nothing to change, or the text is not JSON
std::string withoutFallbacks(std::string_view json);

/// Decodes what is compressed: buffer views, and accessors of primitives, that a model of
/// withoutFallbacks() has.
///
/// @throws Error naming the file, the extension and the cause
void decompress(const std::filesystem::path& path, tinygltf::Model& model);

}  // namespace shadowcache
