#pragma once

#include <filesystem>

#include "common/import/references.h"

namespace tinygltf {
class Model;
}

namespace shadowcache {

/// A .gltf with its buffers and pictures, or a .glb, as tinygltf reads it: little is checked,
/// pictures are still encoded.
///
/// @throws Error naming the file and the cause: missing, truncated, foreign, an extension that is
/// required and unknown here, a file outside of its folder that it may not name
tinygltf::Model readGltfFile(const std::filesystem::path& path, References references);

}  // namespace shadowcache
