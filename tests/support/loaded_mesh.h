#pragma once

#include <filesystem>
#include <string>

#include "common/import/load_mesh.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {

/// The mesh of one file.
inline TriangleMesh loadFile(const std::filesystem::path& path, const MeshOptions& options = {}) {
    return loadMesh({&path, 1}, options);
}

/// The mesh of a file of this name that holds these bytes.
inline TriangleMesh loadBytes(const std::string& name, const std::string& bytes,
                              const MeshOptions& options = {}) {
    const TemporaryFolder folder;
    return loadFile(folder.write(name, bytes), options);
}

/// The mesh of a GltfBuilder's file.
template <class Gltf>
TriangleMesh loadGlb(const Gltf& file, const MeshOptions& options = {}) {
    return loadBytes("a.glb", file.glb(), options);
}

}  // namespace shadowcache::test
