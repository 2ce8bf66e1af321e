#pragma once

#include <string>
#include <vector>

#include "tests/support/gltf_builder.h"

namespace shadowcache::test {

// Files of meshes whose vertices nodes move.

/// Two squares, one on the other at z = 0, whose upper one bends with a joint at (0, 1, 0).
struct SkinnedBar {
    GltfBuilder file;
    int node = -1;   ///< of the mesh; its own transform has no say
    int lower = -1;  ///< joint in the world's origin
    int upper = -1;  ///< joint below it, at (0, 1, 0)
};

inline SkinnedBar skinnedBar() {
    SkinnedBar bar;
    GltfBuilder& file = bar.file;
    const int positions = file.vectors({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 1, 2, 0, 0, 2, 0});
    const int normals = file.vectors({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
    const int joints = file.accessor(std::vector<std::uint8_t>{0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0,
                                                               0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0},
                                     "VEC4", 4);
    const int weights =
        file.accessor(std::vector<float>{1,   0,   0, 0, 1, 0, 0, 0, .5f, .5f, 0, 0,
                                         .5f, .5f, 0, 0, 1, 0, 0, 0, 1,   0,   0, 0},
                      "VEC4", 4);
    const int indices =
        file.accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3, 3, 2, 4, 3, 4, 5}, "SCALAR", 1);
    file.mesh({{"attributes",
                {{"POSITION", positions},
                 {"NORMAL", normals},
                 {"JOINTS_0", joints},
                 {"WEIGHTS_0", weights}}},
               {"indices", indices}});
    bar.upper = file.append("nodes", {{"name", "upper"}, {"translation", {0, 1, 0}}});
    bar.lower = file.root({{"name", "lower"}, {"children", {bar.upper}}});
    const int bind =
        file.accessor(std::vector<float>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,
                                         1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1},
                      "MAT4", 16);
    file.append("skins", {{"joints", {bar.lower, bar.upper}}, {"inverseBindMatrices", bind}});
    bar.node = file.root({{"name", "bar"}, {"mesh", 0}, {"skin", 0}, {"translation", {100, 0, 0}}});
    return bar;
}

/// The square with two morph targets: the first lifts it by 1 along z and tilts its normals toward
/// x, the second moves one corner by 2 along x.
inline GltfBuilder morphedSquare() {
    GltfBuilder file = squareGltf();
    auto& primitive = file.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["NORMAL"] = file.vectors({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
    const int lift = file.vectors({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
    const int tilt = file.vectors({1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0});
    const int corner = file.append(
        "accessors",
        {{"componentType", 5126},
         {"count", 4},
         {"type", "VEC3"},
         {"sparse",
          {{"count", 1},
           {"indices", {{"bufferView", file.view(std::string("\2", 1))}, {"componentType", 5121}}},
           {"values", {{"bufferView", file.view(bytesOf(std::array<float, 3>{2, 0, 0}))}}}}}});
    primitive["targets"] = {{{"POSITION", lift}, {"NORMAL", tilt}}, {{"POSITION", corner}}};
    return file;
}

/// A node that shows mesh 0 at these places.
inline nlohmann::json instancesAt(GltfBuilder& file, const std::vector<float>& places) {
    return {
        {"mesh", 0},
        {"extensions",
         {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", file.vectors(places)}}}}}}}};
}

}  // namespace shadowcache::test
