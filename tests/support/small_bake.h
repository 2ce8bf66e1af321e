#pragma once

#include <filesystem>
#include <iterator>

#include "bake/core/baker.h"
#include "tests/support/test_scenes.h"

namespace shadowcache::test {

/// Floor, box and a roof: a few hundred items.
inline TriangleMesh smallMesh() {
    TriangleMesh mesh;
    addFloor(mesh, 0, -1, 1, -1, 1);
    addBox(mesh, {-0.3f, 0, -0.3f}, {0.4f, 0.6f, 0.5f});
    addFloor(mesh, 1.1f, -1, 0, -1, 1);
    return mesh;
}

inline BakeResult bakeSmall(const BakeOptions& options) {
    const TriangleMesh mesh = smallMesh();
    const Scene scene(mesh);
    return bake(scene, options);
}

inline BakeOptions smallOptions(std::uint64_t seed = 1) {
    BakeOptions options;
    options.spacing = 0.25;
    options.seed = seed;
    return options;
}

/// Entries of a folder.
inline std::size_t filesIn(const std::filesystem::path& folder) {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder),
                                                  std::filesystem::directory_iterator()));
}

}  // namespace shadowcache::test
