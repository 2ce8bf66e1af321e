#pragma once

#include <filesystem>

namespace tinygltf {
class Model;
}

namespace shadowcache {

/// A .gltf with its buffers and pictures, or a .glb, as tinygltf reads it: little is checked,
/// pictures are still encoded.
///
/// @throws Error naming the file and the cause: missing, truncated, foreign, an extension that is
/// required and unknown here
tinygltf::Model readGltfFile(const std::filesystem::path& path);

}  // namespace shadowcache
